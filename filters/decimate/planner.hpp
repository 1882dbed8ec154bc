// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Plans edits: finds the triangles of a removal or a flip, and whether they keep all limits.

#include "decimate/accumulated_errors.hpp"
#include "decimate/direct_errors.hpp"

namespace scanmill::decimating {

/// Only reads the surface, so several planners may work at the same time.
class Planner {
public:
    Planner(const Surface& surface, const Limits& limits, DecimateMode mode)
        : surface_(surface),
          limits_(limits),
          mode_(mode),
          direct_(surface, limits),
          accumulated_(surface, limits) {}

    /// Plans the removal of a vertex. Besides the limits on errors and triangles, a removal has three conditions. No
    /// edge exists twice. No two neighbouring triangles are folded onto each other. No new triangle intersects a
    /// triangle that the old ones did not intersect.
    void plan_removal(u32 vertex, Edit& edit);
    /// Plans the flip of an edge. The conditions of plan_removal() apply, and the least angle of the two triangles must
    /// grow.
    void plan_flip(u32 half_edge, Edit& edit);

    /// Whether the new triangles intersect triangles that the old ones do not intersect. `stamp`: skips parts of the
    /// mesh that did not change since then, as BoxTree::for_each_meeting() does.
    bool intersects(const Edit& edit, u32 stamp);

    /// Estimates the error of removing a vertex, as a length. For a ring vertex, takes the root mean square of its
    /// distances to the planes of the triangles at the vertex, weighted by area. The estimate is the least of these
    /// values. Infinite for vertices that cannot be removed.
    double estimate(u32 vertex);

private:
    /// The whole hole, or its part on one side of a feature line.
    struct Side {
        std::vector<HoleCorner> corners;
        Vec3 up = Vec3::Zero();
        double angle_sine = 0;
        std::vector<u32> points;
        // For accumulated errors:
        bool is_height_field = true;  ///< no old triangle faces away from `up`
        std::vector<SignedErrors> old_errors;
        std::vector<OldEdge> old_edges;
        std::vector<u32> ring_triangles;
    };

    bool find_sides(u32 vertex);
    void find_side(u32 vertex, u32 first, u32 corners, bool is_cut, Side& side) const;
    bool add_line_errors(u32 vertex);
    bool triangulate(const Side& side, const Vec3* removed, Edit& edit);
    bool folds(const Edit& edit) const;
    bool exceeds_valence(const Edit& edit) const;
    Vec3 normal_of(const Triangle& triangle) const;
    double least_angle_sine(const Triangle& triangle) const;

    const Surface& surface_;
    const Limits& limits_;
    DecimateMode mode_;
    DirectErrors direct_;
    AccumulatedErrors accumulated_;
    HoleTriangulator triangulator_;
    std::vector<HoleTriangle> triangles_;
    std::vector<u32> ring_, star_;  ///< vertices of the ring; half-edges from the vertex to them
    std::vector<BoundingBox> boxes_;  ///< boxes of the planned triangles
    std::vector<u32> outside_;  ///< half-edges outside the hole's edges
    Side sides_[2];
    std::size_t side_count_ = 0;
    u32 line_ends_[2] = {};
    SignedErrors line_;
};

}  // namespace scanmill::decimating
