// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The triangles that inserted points add to the surface.
///
/// A new point tests the boundary edges near it, nearest first. The first edge whose triangle passes all tests is the
/// point's winner edge. Further triangles follow at the ends of the new edges, where the outside angle is small. Others
/// follow at boundaries near the point, so fronts that meet are joined. A point over a triangle splits it instead.
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
    double edge_share;  ///< edges are shorter than this share of max_edge
    double least_sine;  ///< smallest sine of the triangle's smallest angle
    double joint_cosine;  ///< smallest cosine between the normals at a common edge other than the winner edge
    double point_cosine;  ///< smallest cosine between the normals of the triangle and of its points
    double sharp_cosine;  ///< point_cosine for points at sharp edges
    /// If set, the sphere around the triangle's circumcircle contains no boundary point. With `leaves_room`, it also
    /// contains no point that is in no triangle yet.
    bool empty_circle;
    bool leaves_room;  ///< if set, no point that is in no triangle yet lies over the triangle
    bool in_space;  ///< if set, intersections are tested in space everywhere
};

/// The limits of the paper's tests of a winner edge. The check triangle joins the new point to the edge between the
/// winner edge's triangle and a neighbour of that triangle.
struct WinnerLimits {
    /// theta: smallest cosine between the normals of the new triangle and of the winner edge's triangle.
    double normal_cosine;
    /// gamma: the cosine between the normals of the neighbour and of the check triangle must be above this.
    double neighbour_cosine;
    /// psi: the point overlaps the winner edge's triangle if the cosine between the normals of that triangle and of the
    /// check triangle is at least this.
    double overlap_cosine;
    double overlap_tangent;  ///< tangent of the angle psi
};

enum class Outcome {
    joined,  ///< the point has new triangles at a boundary
    split,  ///< the point split a triangle
    first,  ///< the point forms a first triangle
    loose,  ///< the point is in no triangle
    extra  ///< the point is in no triangle, because the surface is discontinuous at the nearest edge
};

class Triangulation {
public:
    /// `up`: the side that the first triangles' normals point to.
    Triangulation(Surface& surface, double max_edge, const Vec3& up, const WinnerLimits& winner);

    /// Adds triangles at a point that is in no triangle. `near` are all other points at a distance below max_edge,
    /// ascending by distance. If `may_start`, the point may form a first triangle with two other loose points.
    Outcome insert(u32 point, std::span<const u32> near, bool may_start, const Limits& limits);
    /// Adds triangles at a boundary point, where the outside angle is small and at boundaries near it. Returns whether
    /// any triangle was added.
    bool complete(u32 point, std::span<const u32> near, const Limits& limits);

    /// Removes meshes of a few points, because they may hover over other triangles. Their points wait again.
    void remove_small_meshes();

    bool is_inserted(u32 point) const { return inserted_[point]; }
    /// Whether the point is inserted and in no triangle.
    bool is_loose(u32 point) const { return inserted_[point] && !surface_.is_used(point); }
    /// Whether the point is in a triangle and on the boundary.
    bool is_open(u32 point) const { return surface_.states[point] == growing::PointState::front; }
    /// A point of the surface near the point that was inserted last, in the mesh that it joined.
    u32 partner() const { return partner_; }

private:
    /// A boundary half-edge from → to, seen from a point.
    struct Candidate {
        double squared;  ///< squared distance from the point to the half-edge
        /// Cosine between the direction to the point and the outward direction in the plane of the edge's triangle.
        double outward;
        u32 from, to;
    };
    enum class Verdict { create, split, extra };

    /// Fills candidates_: the boundary edges with both ends near the point, nearest first.
    void collect(u32 point, std::span<const u32> near);
    /// The paper's tests of the angles theta, gamma and psi.
    Verdict judge(u32 point, const Candidate& edge) const;
    /// Whether the triangle from → apex → to may be added at the boundary edge from → to. `near` are the points around
    /// one of its corners.
    bool fits(const Triangle& triangle, std::span<const u32> near, const Limits& limits, bool at_winner);
    /// Whether the surface is flat at the triangle, so that its corners belong to one sheet.
    bool is_flat(const Triangle& triangle) const;
    /// Whether the apex belongs to another mesh, which has the opposite orientation.
    bool is_reversed_at(const Triangle& triangle) const;
    /// Whether the triangle neither overlaps nor intersects other triangles, and covers no point near it.
    bool is_free(const Triangle& triangle, const Vec3& normal, std::span<const u32> near, const Limits& limits);
    bool intersects(const Triangle& triangle, std::span<const u32> near);

    /// Splits the triangle that the point lies over, or both triangles at an edge if the point lies on that edge.
    bool split_covering(u32 point, std::span<const u32> near, const Limits& limits);
    /// Forms the triangle of least circumradius with two other loose points.
    bool start(u32 point, std::span<const u32> near, const Limits& limits);
    /// Adds a triangle at the narrowest boundary corner where it fits. The corner is at the point, or next to it on the
    /// boundary.
    bool close_corners(u32 point, std::span<const u32> near, const Limits& limits);
    /// Adds one triangle between the point, which is on the boundary, and another boundary edge near it.
    bool join_others(u32 point, std::span<const u32> near, const Limits& limits);

    /// Joins two meshes with opposite orientations: reverses the smaller one and adds the triangle, if it fits then.
    bool join_reversed(const Triangle& triangle, std::span<const u32> near, const Limits& limits);

    void add(const Triangle& triangle);
    void remove(const Triangle& triangle);
    void update(u32 point);
    /// Reverses the triangles in the fan of a point, but not in the fans of their other corners.
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
