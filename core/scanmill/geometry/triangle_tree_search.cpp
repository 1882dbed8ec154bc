// SPDX-License-Identifier: GPL-3.0-or-later
/// The questions to a TriangleTree; triangle_tree.cpp builds it.
#include <algorithm>
#include <array>
#include <cassert>

#include "scanmill/geometry/outward_floats.hpp"
#include "scanmill/geometry/triangle_distance.hpp"
#include "scanmill/geometry/triangle_tree.hpp"

namespace scanmill {

namespace {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

Float4 larger(Float4 a, Float4 b) { return a > b ? a : b; }
Float4 all(float value) { return Float4{value, value, value, value}; }
Float4 load(const float* values) { return Float4{values[0], values[1], values[2], values[3]}; }

/// A point as an interval of floats that holds it.
struct FloatPoint {
    explicit FloatPoint(const Vec3& point) {
        for (int axis = 0; axis < 3; ++axis) {
            // Far outside, a point held nearer is still outside, and its square is a float.
            const double held = std::clamp(point[axis], -1e18, 1e18);
            low[axis] = all(rounded_down(held));
            high[axis] = all(rounded_up(held));
        }
    }
    /// Squared distances to four boxes, from below but for a few roundings.
    Float4 squared_distances(const float (&bounds)[6][4]) const {
        Float4 sum = all(0);
        for (int axis = 0; axis < 3; ++axis) {
            const Float4 below = load(bounds[axis]) - high[axis];
            const Float4 above = low[axis] - load(bounds[axis + 3]);
            const Float4 outside = larger(larger(below, above), all(0));
            sum += outside * outside;
        }
        return sum;
    }
    Float4 low[3], high[3];
};

/// No box nearer than this can hold a triangle as near as `squared`: more than all roundings together.
float reach(double squared, double scale) {
    return static_cast<float>(std::min(squared * (scale * scale) * (1 + 0x1p-18), 1e38)) + 1e-36f;
}

}  // namespace

Vec3 TriangleTree::nearest_point(const Vec3& point, u32 place) const {
    const Corners& corners = corners_[place];
    return nearest_on_triangle(point, corners.a, corners.b, corners.c);
}

NearestTriangle TriangleTree::nearest(const Vec3& point, u32 hint) const {
    assert(point.allFinite());
    struct Waiting {
        float bound;
        u32 node;
    };
    std::array<Waiting, (arity - 1) * deepest + 1> stack;
    std::size_t waiting = 0;
    NearestTriangle best;
    float limit = std::numeric_limits<float>::infinity();
    const auto offer = [&](std::size_t place) {
        const double squared = squared_distance(point, static_cast<u32>(place));
        if (squared < best.squared_distance || (squared == best.squared_distance && rows_[place] < best.triangle)) {
            best = {rows_[place], static_cast<u32>(place), squared};
            limit = reach(squared, scale_);
        }
    };
    if (hint < corners_.size()) offer(hint);

    const FloatPoint query(scaled(point));
    stack[waiting++] = {0, 0};
    while (waiting > 0) {
        const Waiting next = stack[--waiting];
        if (next.bound > limit) continue;
        if (next.node >= nodes_.size()) {
            const std::size_t leaf = next.node - nodes_.size();
            for (std::size_t place = begin_of(leaf, depth_); place < begin_of(leaf + 1, depth_); ++place)
                if (place != hint) offer(place);
            continue;
        }
        const Float4 bounds = query.squared_distances(nodes_[next.node].bounds);
        // Kept in descending order, so that the nearest is popped first.
        const std::size_t bottom = waiting;
        for (u32 i = 0; i < arity; ++i) {
            if (!(bounds[i] <= limit)) continue;
            std::size_t at = waiting++;
            for (; at > bottom && stack[at - 1].bound < bounds[i]; --at) stack[at] = stack[at - 1];
            stack[at] = {bounds[i], static_cast<u32>(arity * next.node + 1 + i)};
        }
    }
    assert(best.triangle != NearestTriangle::none);
    return best;
}

void TriangleTree::meeting(const BoundingBox& box, Array<u32>& rows) const {
    float low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = rounded_down(scaled(box.low)[axis]);
        high[axis] = rounded_up(scaled(box.high)[axis]);
    }
    std::array<u32, (arity - 1) * deepest + 1> stack;
    std::size_t waiting = 0;
    stack[waiting++] = 0;
    while (waiting > 0) {
        const u32 node = stack[--waiting];
        if (node < nodes_.size()) {
            Int4 meets = {-1, -1, -1, -1};
            for (int axis = 0; axis < 3; ++axis)
                meets &= (load(nodes_[node].bounds[axis]) <= all(high[axis])) &
                         (load(nodes_[node].bounds[axis + 3]) >= all(low[axis]));
            for (u32 i = 0; i < arity; ++i)
                if (meets[i]) stack[waiting++] = static_cast<u32>(arity * node + 1 + i);
            continue;
        }
        const std::size_t leaf = node - nodes_.size();
        for (std::size_t place = begin_of(leaf, depth_); place < begin_of(leaf + 1, depth_); ++place) {
            const Corners& at = corners_[place];
            const Vec3 least = at.a.cwiseMin(at.b).cwiseMin(at.c), most = at.a.cwiseMax(at.b).cwiseMax(at.c);
            if ((least.array() <= box.high.array()).all() && (most.array() >= box.low.array()).all())
                rows.push_back(rows_[place]);
        }
    }
}

}  // namespace scanmill
