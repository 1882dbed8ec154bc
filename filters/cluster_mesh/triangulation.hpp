// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The triangles that inserted points add to the surface.
///
/// A new point looks at the boundary edges near it, nearest first. The first one whose triangle passes all tests is its
/// winner edge; triangles at the ends of the new edges follow, where the outside angle is small, and triangles at other
/// boundaries near it, so fronts that meet are joined. A point over a triangle splits it.
///
/// Source: Sangveraphunsiri, Srirakulchai 2006, section 3, made robust.

#include <span>
#include <vector>

#include "cluster_mesh/mesh_components.hpp"
#include "scanmill/geometry/growing/intersections.hpp"
#include "scanmill/geometry/growing/surface.hpp"

namespace scanmill::clustering {

using growing::invalid_index;
using growing::Surface;

/// Limits of every triangle. Angles are stored as the sines and cosines that are compared.
struct Limits {
    double edge_share;  ///< of max_edge: edges are shorter
    double least_sine;  ///< sine of the triangle's smallest angle
    double joint_cosine;  ///< least, between the normals of triangles that share an edge other than a winner edge
    double point_cosine;  ///< least, between the normals of the triangle and of its points
    double sharp_cosine;  ///< the same for points at edges
    bool empty_circle;  ///< no such point, and no boundary point, may lie in the sphere around its circumcircle
    bool leaves_room;  ///< no point that is in no triangle yet may lie over it
    bool in_space;  ///< test intersections in space everywhere, not only where surfaces that face apart are near
};

/// The limits of the paper's tests of a winner edge.
struct WinnerLimits {
    double normal_cosine;  ///< theta: least, between the normals of the new triangle and the winner edge's
    double neighbour_cosine;  ///< gamma: above it, between a neighbour of the winner's triangle and the check triangle
    double overlap_cosine;  ///< psi: from it on, between the winner's triangle and the check triangle, the point
                            ///< overlaps it
    double overlap_tangent;  ///< tangent of the same angle
};

enum class Outcome {
    joined,  ///< new triangles at a boundary
    split,  ///< it split a triangle
    first,  ///< a first triangle
    loose,  ///< no triangle
    extra  ///< no triangle, as the surface is discontinuous at the winner edge
};

class Triangulation {
public:
    /// `up`: the side that the first triangles' normals point to.
    Triangulation(Surface& surface, double max_edge, const Vec3& up, const WinnerLimits& winner);

    /// Adds triangles at a point that is in none. `near`: all other points at a distance below max_edge, ascending by
    /// distance. `may_start`: three loose points may form a first triangle.
    Outcome insert(u32 point, std::span<const u32> near, bool may_start, const Limits& limits);
    /// Adds triangles at a boundary point: where the outside angle is small, and at boundaries near it. Returns whether
    /// there were any.
    bool complete(u32 point, std::span<const u32> near, const Limits& limits);

    /// Removes meshes of a few points, which may hover over others; their points wait again.
    void remove_small_meshes();

    bool is_inserted(u32 point) const { return inserted_[point]; }
    /// Inserted and in no triangle.
    bool is_loose(u32 point) const { return inserted_[point] && !surface_.is_used(point); }
    /// Whether the point is in a triangle and on the boundary.
    bool is_open(u32 point) const { return surface_.states[point] == growing::PointState::front; }
    /// A point of the surface near the point that was inserted last, in the mesh that it joined.
    u32 partner() const { return partner_; }

private:
    /// A boundary half-edge from → to, seen from a point.
    struct Candidate {
        double squared;  ///< distance of the point
        double outward;  ///< cosine between the direction to the point and outwards in the plane of the edge's triangle
        u32 from, to;
    };
    enum class Verdict { create, split, extra };

    /// Fills candidates_: the boundary edges with both ends near the point, nearest first.
    void collect(u32 point, std::span<const u32> near);
    /// The paper's tests of the angles theta, gamma and psi.
    Verdict judge(u32 point, const Candidate& edge) const;
    /// Whether triangle from → apex → to, at the boundary edge from → to, may be added. `near`: around a corner of it.
    bool fits(const Triangle& triangle, std::span<const u32> near, const Limits& limits, bool at_winner);
    /// Whether the surface is flat at the triangle, so that its corners belong to one sheet.
    bool is_flat(const Triangle& triangle) const;
    /// Whether the apex belongs to another mesh, whose triangles are on the other side.
    bool is_reversed_at(const Triangle& triangle) const;
    /// Whether the triangle overlaps and intersects no others, and leaves the points near it uncovered.
    bool is_free(const Triangle& triangle, const Vec3& normal, std::span<const u32> near, const Limits& limits);
    bool intersects(const Triangle& triangle, std::span<const u32> near);

    /// Splits the triangle that the point lies over, or the two at an edge that it lies on.
    bool split_covering(u32 point, std::span<const u32> near, const Limits& limits);
    /// Forms the triangle of least circumradius with two other loose points.
    bool start(u32 point, std::span<const u32> near, const Limits& limits);
    /// Adds one triangle at a corner of the boundary at the point or beside it, the narrowest that fits.
    bool close_corners(u32 point, std::span<const u32> near, const Limits& limits);
    /// Adds one triangle between the point, which is on the boundary, and another boundary edge near it.
    bool join_others(u32 point, std::span<const u32> near, const Limits& limits);

    /// Joins two meshes with opposite orientations: reverses the smaller one and adds the triangle, if it fits then.
    bool join_reversed(const Triangle& triangle, std::span<const u32> near, const Limits& limits);

    void add(const Triangle& triangle);
    void remove(const Triangle& triangle);
    void update(u32 point);
    /// Reverses the triangles at a point, in its own record only.
    void reverse_at(u32 point);

    double squared(u32 a, u32 b) const { return (surface_.positions[a] - surface_.positions[b]).squaredNorm(); }
    bool is_short(u32 a, u32 b, double share = 1) const { return squared(a, b) < share * share * squared_edge_; }

    Surface& surface_;
    double squared_edge_;
    Vec3 up_;
    WinnerLimits winner_;
    MeshComponents components_;
    std::vector<bool> inserted_;
    growing::NearTriangles near_triangles_;
    std::vector<Candidate> candidates_;
    u32 partner_ = invalid_index;
};

}  // namespace scanmill::clustering
