// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The connected components of a growing mesh, with lists of their points. The lists are used to reverse a component.

#include <numeric>
#include <utility>
#include <vector>

#include "scanmill/data/array.hpp"

namespace scanmill::clustering {

/// At first every point is a component. Cost: O(n log n) for all calls of join().
class MeshComponents {
public:
    explicit MeshComponents(std::size_t points) : label_(points), next_(points), size_(points, 1) {
        std::iota(label_.begin(), label_.end(), u32(0));
        std::iota(next_.begin(), next_.end(), u32(0));
    }

    bool are_joined(u32 a, u32 b) const { return label_[a] == label_[b]; }
    std::size_t size(u32 point) const { return size_[label_[point]]; }
    void join(u32 a, u32 b) {
        if (are_joined(a, b)) return;
        if (size(a) < size(b)) std::swap(a, b);
        size_[label_[a]] += size_[label_[b]];
        for_each(b, [&](u32 point) { label_[point] = label_[a]; });
        std::swap(next_[a], next_[b]);
    }
    /// Makes every point in the component of `point` a component of its own.
    void separate(u32 point) {
        for (u32 at = point, next = next_[at];; at = std::exchange(next, next_[next])) {
            label_[at] = next_[at] = at;
            size_[at] = 1;
            if (next == point) return;
        }
    }
    template <class Action>
    void for_each(u32 point, Action&& action) const {
        u32 at = point;
        do {
            action(at);
            at = next_[at];
        } while (at != point);
    }

private:
    std::vector<u32> label_;
    /// The next point of the component, in a ring.
    std::vector<u32> next_;
    std::vector<u32> size_;
};

}  // namespace scanmill::clustering
