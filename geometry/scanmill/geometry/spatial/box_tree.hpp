// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds the items whose bounding boxes meet a box, while items change and disappear.
///
/// Every node has four children. Items keep their leaves. When a box changes, the boxes above it are refitted up to the
/// first node that stays the same. A mesh that is edited keeps its triangles where they were, so the tree stays
/// efficient until most items are gone; then build a new tree.

#include <array>
#include <span>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/bounds.hpp"

namespace scanmill {

class BoxTree {
public:
    /// An item with an empty box is absent. Pre: fewer than 2^31 boxes; boxes that are not empty are finite. Cost: O(n
    /// log n); about 40 bytes per item.
    explicit BoxTree(std::span<const BoundingBox> boxes);

    /// Number of items present at construction.
    std::size_t leaves() const { return items_.size(); }
    /// Number of items present now.
    std::size_t size() const { return size_; }
    /// Replaces the item's box; an empty box removes the item. `stamp`: see for_each_meeting(); it must not be below
    /// the stamp of the last change. Pre: the item was present at construction.
    void change(u32 item, const BoundingBox& box, u32 stamp = 0);

    /// Calls action(item) for every item whose box meets `box`, borders included. Boxes are compared as floats, rounded
    /// outwards, so a few more items may be reported. Subtrees without a change of at least `stamp` are skipped; all
    /// items of other subtrees are reported, whatever their stamp. Safe from several threads between changes.
    template <class Action>
    void for_each_meeting(const BoundingBox& box, Action&& action, u32 stamp = 0) const {
        if (levels_.empty()) return;
        const FloatBox query = rounded_outwards(box);
        struct Entry {
            u32 level, node;
        };
        std::array<Entry, 3 * deepest + 1> stack;
        std::size_t waiting = 0;
        stack[waiting++] = {static_cast<u32>(levels_.size() - 1), 0};
        while (waiting > 0) {
            const Entry entry = stack[--waiting];
            const Node& node = levels_[entry.level][entry.node];
            if (node.stamp < stamp) continue;
            const auto meets = meeting(node, query);
            for (u32 i = 0; i < arity; ++i) {
                if (!meets[i]) continue;
                const u32 child = arity * entry.node + i;
                if (entry.level == 0)
                    action(items_[child]);
                else
                    stack[waiting++] = {entry.level - 1, child};
            }
        }
    }

private:
    static constexpr u32 arity = 4;
    static constexpr std::size_t deepest = 16;  ///< 4^16 leaves hold any u32
    using Float4 = float __attribute__((vector_size(16)));
    using Int4 = std::int32_t __attribute__((vector_size(16)));
    struct FloatBox {
        float low[3], high[3];
        bool operator==(const FloatBox&) const = default;
    };
    struct Node {
        Float4 low[3], high[3];
        u32 stamp;
    };

    static FloatBox rounded_outwards(const BoundingBox& box);
    static Int4 meeting(const Node& node, const FloatBox& box) {
        Int4 result = {-1, -1, -1, -1};
        for (int axis = 0; axis < 3; ++axis) {
            const float low = box.low[axis], high = box.high[axis];
            result &=
                (node.low[axis] <= Float4{high, high, high, high}) & (node.high[axis] >= Float4{low, low, low, low});
        }
        return result;
    }
    static void set_child(Node& node, u32 child, const FloatBox& box);
    static FloatBox bounds_of(const Node& node);

    /// Levels from the nodes above the items up to the root.
    std::vector<Array<Node>> levels_;
    Array<u32> items_;  ///< item of every leaf
    Array<u32> leaves_;  ///< leaf of every item
    std::size_t size_ = 0;
    std::vector<bool> is_there_;
};

}  // namespace scanmill
