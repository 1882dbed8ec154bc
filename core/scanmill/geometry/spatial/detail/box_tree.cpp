// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/detail/box_tree.hpp"

#include <cassert>

#include "scanmill/base/parallel.hpp"

namespace scanmill {

namespace {

/// Smaller leaves cost boxes, larger ones distances to points that are too far.
constexpr std::size_t most_in_leaf = 8;
constexpr std::size_t chunk = 1 << 12;

}  // namespace

BoxTree::BoxTree(std::span<const Vec3> places, unsigned threads) : points_(places.size()) {
    assert(!places.empty() && places.size() <= ~u32(0));
    for (u32 number = 0; number < places.size(); ++number) points_[number] = {places[number], number};
    while (places.size() >> depth_ > most_in_leaf) ++depth_;
    boxes_.resize(2 * leaves());
    const auto for_level = [&](u64 first, auto&& action) {
        const std::size_t nodes_per_chunk = std::max<std::size_t>(1, chunk * first / places.size());
        for_each_chunk(threads, first, nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
            for (u64 node = first + begin; node < first + end; ++node) action(node);
        });
    };
    // Boxes are made anew from the points on every level: it costs less than the selection beside it.
    for (u64 first = 1; first < leaves(); first *= 2) for_level(first, [&](u64 node) { bound(node), split(node); });
    for_level(leaves(), [&](u64 node) { bound(node); });
}

u64 BoxTree::leaf_of(std::size_t index) const {
    const u64 leaf = (((u64(index) + 1) << depth_) - 1) / points_.size();
    return leaves() + leaf;
}

void BoxTree::bound(u64 node) {
    BoundingBox box;
    for (const Point& point : points_of(node)) {
        box.low = box.low.cwiseMin(point.position);
        box.high = box.high.cwiseMax(point.position);
    }
    boxes_[node] = box;
}

void BoxTree::split(u64 node) {
    int axis;
    (boxes_[node].high - boxes_[node].low).maxCoeff(&axis);
    const auto begin = points_.begin() + static_cast<std::ptrdiff_t>(begin_of(node, 0));
    const auto middle = points_.begin() + static_cast<std::ptrdiff_t>(begin_of(2 * node, 1));
    const auto end = points_.begin() + static_cast<std::ptrdiff_t>(begin_of(node, 1));
    std::nth_element(begin, middle, end, [axis](const Point& a, const Point& b) {
        const double x = a.position[axis], y = b.position[axis];
        return x != y ? x < y : a.number < b.number;
    });
}

}  // namespace scanmill
