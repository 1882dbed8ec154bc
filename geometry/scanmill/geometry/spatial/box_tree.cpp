// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/box_tree.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "scanmill/geometry/spatial/spatial_order.hpp"

namespace scanmill {

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

float rounded_down(double value) {
    const float nearest = static_cast<float>(value);
    return static_cast<double>(nearest) <= value ? nearest : std::nextafterf(nearest, -infinite);
}

}  // namespace

BoxTree::FloatBox BoxTree::rounded_outwards(const BoundingBox& box) {
    FloatBox result;
    for (int axis = 0; axis < 3; ++axis) {
        result.low[axis] = rounded_down(box.low[axis]);
        result.high[axis] = -rounded_down(-box.high[axis]);
    }
    return result;
}

void BoxTree::set_child(Node& node, u32 child, const FloatBox& box) {
    for (int axis = 0; axis < 3; ++axis) {
        node.low[axis][child] = box.low[axis];
        node.high[axis][child] = box.high[axis];
    }
}

BoxTree::FloatBox BoxTree::bounds_of(const Node& node) {
    FloatBox result;
    for (int axis = 0; axis < 3; ++axis) {
        const Float4 &low = node.low[axis], &high = node.high[axis];
        result.low[axis] = std::min(std::min(low[0], low[1]), std::min(low[2], low[3]));
        result.high[axis] = std::max(std::max(high[0], high[1]), std::max(high[2], high[3]));
    }
    return result;
}

BoxTree::BoxTree(std::span<const BoundingBox> boxes) : is_there_(boxes.size()) {
    assert(boxes.size() < (u32(1) << 31));
    Array<Vec3> centres;
    for (u32 item = 0; item < boxes.size(); ++item) {
        is_there_[item] = !boxes[item].empty();
        if (!is_there_[item]) continue;
        centres.push_back(boxes[item].low + (boxes[item].high - boxes[item].low) / 2);
        items_.push_back(item);
    }
    size_ = items_.size();
    if (size_ == 0) return;
    Array<u32> ordered(size_);
    const Array<u32> order = spatial_order(centres);
    for (u32 i = 0; i < size_; ++i) ordered[i] = items_[order[i]];
    items_ = std::move(ordered);
    leaves_.assign(boxes.size(), ~u32(0));
    for (u32 leaf = 0; leaf < size_; ++leaf) leaves_[items_[leaf]] = leaf;

    Node nothing;
    for (int axis = 0; axis < 3; ++axis) {
        nothing.low[axis] = Float4{infinite, infinite, infinite, infinite};
        nothing.high[axis] = -nothing.low[axis];
    }
    nothing.stamp = 0;
    levels_.emplace_back((size_ + arity - 1) / arity, nothing);
    for (u32 leaf = 0; leaf < size_; ++leaf)
        set_child(levels_[0][leaf / arity], leaf % arity, rounded_outwards(boxes[items_[leaf]]));
    while (levels_.back().size() > 1) {
        const std::size_t below = levels_.size() - 1;
        levels_.emplace_back((levels_[below].size() + arity - 1) / arity, nothing);
        for (u32 node = 0; node < levels_[below].size(); ++node)
            set_child(levels_[below + 1][node / arity], node % arity, bounds_of(levels_[below][node]));
    }
}

void BoxTree::change(u32 item, const BoundingBox& box, u32 stamp) {
    assert(item < leaves_.size() && leaves_[item] != ~u32(0));
    const bool is_there = !box.empty();
    size_ += static_cast<std::size_t>(is_there) - static_cast<std::size_t>(is_there_[item]);
    is_there_[item] = is_there;
    FloatBox bounds{{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}};
    if (is_there) bounds = rounded_outwards(box);
    bool is_changed = true;
    u32 child = leaves_[item];
    for (Array<Node>& level : levels_) {
        Node& node = level[child / arity];
        if (!is_changed && node.stamp >= stamp) return;
        node.stamp = stamp;
        if (is_changed) {
            const FloatBox before = bounds_of(node);
            set_child(node, child % arity, bounds);
            bounds = bounds_of(node);
            is_changed = !(bounds == before);
        }
        child /= arity;
    }
}

}  // namespace scanmill
