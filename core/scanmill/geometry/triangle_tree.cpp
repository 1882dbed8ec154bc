// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/triangle_tree.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "scanmill/filter/parallel.hpp"
#include "scanmill/geometry/outward_floats.hpp"

namespace scanmill {

namespace {

constexpr std::size_t largest_leaf = 4;
/// Of the scaled extent: far above the rounding of a distance in doubles, far below that of a float.
constexpr double widening = 0x1p-40;

struct Centroid {
    float at[3];
    u32 row;
};

/// Puts the `middle - first` smallest along the longest axis first; equal ones by row.
void split(Centroid* first, Centroid* middle, Centroid* last) {
    if (middle == first || middle == last) return;
    float low[3], high[3];
    std::copy_n(first->at, 3, low);
    std::copy_n(first->at, 3, high);
    for (const Centroid* c = first; c != last; ++c)
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], c->at[axis]);
            high[axis] = std::max(high[axis], c->at[axis]);
        }
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis)
        if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
    std::nth_element(first, middle, last, [longest](const Centroid& a, const Centroid& b) {
        return a.at[longest] != b.at[longest] ? a.at[longest] < b.at[longest] : a.row < b.row;
    });
}

}  // namespace

TriangleTree::TriangleTree(std::span<const Vec3> positions, std::span<const Triangle> triangles, unsigned threads) {
    assert(!triangles.empty() && triangles.size() < ~u32(0));
    BoundingBox box;
    for (const Triangle& triangle : triangles)
        for (u32 vertex : triangle) {
            box.low = box.low.cwiseMin(positions[vertex]);
            box.high = box.high.cwiseMax(positions[vertex]);
        }
    centre_ = box.low + (box.high - box.low) / 2;
    if (const double extent = (box.high - box.low).maxCoeff(); extent > 0)
        scale_ = std::ldexp(1.0, -std::ilogb(extent));

    while (triangles.size() > largest_leaf << (2 * depth_)) ++depth_;
    assert(depth_ <= deepest);
    sort_triangles(positions, triangles, threads);
    bound_nodes(threads);
}

void TriangleTree::sort_triangles(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                  unsigned threads) {
    constexpr std::size_t chunk = 1 << 14;
    const std::size_t count = triangles.size();
    Array<Centroid> centroids(count);
    for_each_chunk(threads, count, chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const auto& [a, b, c] = triangles[row];
            const Vec3 third = scaled(positions[a]) + scaled(positions[b]) + scaled(positions[c]);
            for (int axis = 0; axis < 3; ++axis) centroids[row].at[axis] = static_cast<float>(third[axis]);
            centroids[row].row = static_cast<u32>(row);
        }
    });
    rows_.resize(count);
    for (unsigned level = 0; level < depth_; ++level)
        for_each_chunk(threads, std::size_t(1) << (2 * level), 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t node = begin; node < end; ++node) {
                std::array<Centroid*, arity + 1> cut;
                for (std::size_t i = 0; i <= arity; ++i)
                    cut[i] = centroids.data() + begin_of(arity * node + i, level + 1);
                split(cut[0], cut[2], cut[4]);
                split(cut[0], cut[1], cut[2]);
                split(cut[2], cut[3], cut[4]);
            }
        });
    corners_.resize(count);
    for_each_chunk(threads, count, chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t place = begin; place < end; ++place) {
            rows_[place] = centroids[place].row;
            const auto& [a, b, c] = triangles[rows_[place]];
            corners_[place] = {positions[a], positions[b], positions[c]};
        }
    });
}

void TriangleTree::bound_nodes(unsigned threads) {
    std::size_t first = ((std::size_t(1) << (2 * depth_)) - 1) / 3;
    nodes_.resize(first);
    while (first > 0) {
        const std::size_t end = first;
        first = (first - 1) / arity;
        for_each_chunk(threads, end - first, 256, [&](std::size_t from, std::size_t to) {
            for (std::size_t node = first + from; node < first + to; ++node) bound_node(node);
        });
    }
}

void TriangleTree::bound_node(std::size_t node) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < arity; ++i) {
        float low[3] = {infinity, infinity, infinity}, high[3] = {-infinity, -infinity, -infinity};
        const std::size_t child = arity * node + 1 + i;
        if (child < nodes_.size()) {
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = *std::ranges::min_element(nodes_[child].bounds[axis]);
                high[axis] = *std::ranges::max_element(nodes_[child].bounds[axis + 3]);
            }
        } else {
            const std::size_t leaf = child - nodes_.size();
            for (std::size_t place = begin_of(leaf, depth_); place < begin_of(leaf + 1, depth_); ++place) {
                const Corners& corners = corners_[place];
                for (const Vec3& corner : {corners.a, corners.b, corners.c})
                    for (int axis = 0; axis < 3; ++axis) {
                        const double at = scaled(corner)[axis];
                        low[axis] = std::min(low[axis], rounded_down(at - widening));
                        high[axis] = std::max(high[axis], rounded_up(at + widening));
                    }
            }
        }
        for (int axis = 0; axis < 3; ++axis) {
            nodes_[node].bounds[axis][i] = low[axis];
            nodes_[node].bounds[axis + 3][i] = high[axis];
        }
    }
}

TriangleTree tree_of_points(std::span<const Vec3> positions, unsigned threads) {
    Array<Triangle> triangles(positions.size());
    for (u32 i = 0; i < triangles.size(); ++i) triangles[i] = {i, i, i};
    return TriangleTree(positions, triangles, threads);
}

}  // namespace scanmill
