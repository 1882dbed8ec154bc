// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A balanced kd-tree without pointers: points sorted so that every node's are side by side, and a box for every node.
///
/// Node 1 is the root, the children of node i are 2 i and 2 i + 1, so all leaves are on one level and a node's range of
/// points follows from its number. Halves are taken at the median of the box's longest edge, by (coordinate, number).
/// Rounded to nearest, subtraction, squaring and adding are monotone: the computed distance to a box never exceeds
/// that to a point in it, so what is left out by its box would have been left out by itself.

#include <algorithm>
#include <bit>
#include <span>

#include "scanmill/data/array.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill {

inline double squared_distance(const Vec3& a, const Vec3& b) {
    const double x = a.x() - b.x(), y = a.y() - b.y(), z = a.z() - b.z();
    return (x * x + y * y) + z * z;
}
/// Between the nearest points of two boxes.
inline double squared_distance(const BoundingBox& a, const BoundingBox& b) {
    double gap[3];
    for (int axis = 0; axis < 3; ++axis) {
        const double above = b.low[axis] - a.high[axis], below = a.low[axis] - b.high[axis];
        gap[axis] = std::max(std::max(above, below), 0.0);
    }
    return (gap[0] * gap[0] + gap[1] * gap[1]) + gap[2] * gap[2];
}
inline double squared_distance(const BoundingBox& box, const Vec3& p) {
    return squared_distance(box, BoundingBox{p, p});
}

class BoxTree {
public:
    struct Point {
        Vec3 position;
        u32 number;
    };

    /// Numbers the places in the order given. Pre: at least one, finite, fewer than 2^32.
    BoxTree(std::span<const Vec3> places, unsigned threads);

    std::span<const Point> points() const { return points_; }
    std::span<const Point> points_of(u64 node) const {
        const std::size_t begin = begin_of(node, 0);
        return std::span(points_).subspan(begin, begin_of(node, 1) - begin);
    }
    const BoundingBox& box(u64 node) const { return boxes_[node]; }
    u64 leaves() const { return u64(1) << depth_; }
    u64 leaf(u64 index) const { return leaves() + index; }
    /// The leaf that holds points()[index].
    u64 leaf_of(std::size_t index) const;

    /// The smallest node around `node` with at least `count` points; the root when there are fewer.
    u64 ancestor_with(std::size_t count, u64 node) const {
        while (node > 1 && points_of(node).size() < count) node /= 2;
        return node;
    }

    /// Calls action(points of a leaf) for all leaves whose box is at a squared distance of at most `squared`.
    template <class Action>
    void near(const BoundingBox& from, double squared, Action&& action) const {
        u64 node = 1;
        while (true) {
            if (squared_distance(boxes_[node], from) <= squared) {
                if (node < leaves()) {
                    node *= 2;
                    continue;
                }
                action(points_of(node));
            }
            ++node;
            node >>= std::countr_zero(node);  // up from a right child, to the next one not seen
            if (node == 1) return;
        }
    }

private:
    /// The first point of the node that comes `later` nodes behind this one in its level.
    std::size_t begin_of(u64 node, u64 later) const {
        const int level = static_cast<int>(std::bit_width(node)) - 1;
        return (node - (u64(1) << level) + later) * points_.size() >> level;
    }
    void split(u64 node);
    void bound(u64 node);

    unsigned depth_ = 0;
    Array<Point> points_;
    Array<BoundingBox> boxes_;
};

}  // namespace scanmill
