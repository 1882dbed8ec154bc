// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds the triangle nearest to a point and the triangles in a box, with a tree of bounding boxes over triangles.
///
/// Every node has four children, each with a quarter of its triangles (two splits at the median of the longest axis).
/// So the tree is complete and needs no pointers. Boxes are floats, rounded outwards and widened by more than the
/// rounding error of a distance in doubles. Distances to triangles are doubles. A search over all triangles would
/// therefore give the same results, bit for bit.
///
/// Any set of triangles is allowed; degenerate triangles are segments or points. tree_of_points() treats every point as
/// a triangle with three equal corners.

#include <array>
#include <functional>
#include <span>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill {

struct NearestTriangle {
    static constexpr u32 none = ~u32(0);
    /// Row of the triangle; of equally near triangles, the smallest row.
    u32 triangle = none;
    /// Index of the triangle in the tree's own order. It can be the `hint` of a search from a nearby point.
    u32 slot = none;
    double squared_distance = std::numeric_limits<double>::infinity();
};

class TriangleTree {
public:
    /// Copies the corners. Pre: at least one triangle, fewer than 2^32; finite coordinates, see triangle_distance.hpp.
    /// Cost: O(n log n); about 85 to 110 bytes per triangle. Any number of threads makes the same tree.
    TriangleTree(std::span<const Vec3> positions, std::span<const Triangle> triangles, unsigned threads);

    std::size_t size() const { return rows_.size(); }

    /// The triangle whose nearest_on_triangle() is nearest to `point`; ties: the smallest row. `hint` is the slot of
    /// any triangle. It does not change the result, but a hint near the point makes the search faster. Pre: a finite
    /// point. Safe from several threads. Cost: O(log n) for points near the surface; far away from a round surface many
    /// triangles compete.
    NearestTriangle nearest(const Vec3& point, u32 hint = NearestTriangle::none) const;

    /// Whether nearest(point).squared_distance <= `squared`. Faster than nearest(): the search ends at the first such
    /// triangle and does not look beyond that distance. `hint` is used as in nearest() and receives the slot of that
    /// triangle.
    bool is_within(const Vec3& point, double squared, u32& hint) const;

    /// The point of triangle `slot` (NearestTriangle::slot) nearest to `point`.
    Vec3 nearest_point(const Vec3& point, u32 slot) const;
    double squared_distance(const Vec3& point, u32 slot) const {
        return (nearest_point(point, slot) - point).squaredNorm();
    }

    /// The row of triangle `slot`.
    u32 row(u32 slot) const { return rows_[slot]; }
    /// The corners of triangle `slot`.
    const std::array<Vec3, 3>& corners(u32 slot) const { return corners_[slot]; }

    /// Appends the rows of all triangles whose bounding boxes meet `box` (borders included), in the tree's order.
    void meeting(const BoundingBox& box, Array<u32>& rows) const;

    /// Calls accept(slot) for all triangles whose bounding boxes come within `distance` of the convex hull of one to
    /// three points. It may also be called for a few other triangles. The order is not defined. Stops when `accept`
    /// returns true; returns whether it did. Safe from several threads. Pre: finite points, distance ≥ 0. Cost: O(log
    /// n) and the triangles near the hull.
    bool any_near(std::span<const Vec3> hull, double distance, const std::function<bool(u32 slot)>& accept) const;

private:
    static constexpr std::size_t arity = 4;
    static constexpr unsigned deepest = 16;  ///< 4^16 leaves hold any u32
    struct Node {
        /// Boxes of the children: low.x, low.y, low.z, high.x, high.y, high.z. An empty box has low = infinity, high =
        /// -infinity.
        alignas(16) float bounds[6][arity];
    };

    std::size_t begin_of(std::size_t node_in_level, unsigned level) const {
        return static_cast<std::size_t>(static_cast<u64>(node_in_level) * rows_.size() >> (2 * level));
    }
    void sort_triangles(std::span<const Vec3> positions, std::span<const Triangle> triangles, unsigned threads);
    void bound_nodes(unsigned threads);
    void bound_node(std::size_t node);
    /// Calls offer(slot) for triangles whose boxes are at most `limit` from the point, nearer boxes first. Stops when
    /// `offer` returns true. `limit` is a squared distance in scaled coordinates; `offer` may lower it.
    template <class Offer>
    void search(const Vec3& point, float& limit, const Offer& offer) const;
    Vec3 scaled(const Vec3& point) const { return (point - centre_) * scale_; }

    Vec3 centre_;
    /// A power of two that brings coordinates into [-1, 1].
    double scale_ = 1;
    unsigned depth_ = 0;
    /// Nodes, level by level. The children of node i are 4 i + 1 … 4 i + 4; numbers from nodes_.size() on are leaves.
    Array<Node> nodes_;
    Array<std::array<Vec3, 3>> corners_;
    Array<u32> rows_;
};

/// The tree over points: triangle i is point i. Pre: at least one point, finite.
TriangleTree tree_of_points(std::span<const Vec3> positions, unsigned threads);

}  // namespace scanmill
