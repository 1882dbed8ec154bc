// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Plans edits: finds the triangles of a removal or a flip, and whether they keep all limits.

#include "decimate/accumulated_errors.hpp"
#include "decimate/direct_errors.hpp"

namespace scanmill::decimating {

/// Reads the surface only, so several planners may work at the same time.
class Planner {
public:
    Planner(const Surface& surface, const Limits& limits, DecimateMode mode)
        : surface_(surface),
          limits_(limits),
          mode_(mode),
          direct_(surface, limits),
          accumulated_(surface, limits) {}

    /// The removal of a vertex. It is possible if, in addition to the limits on errors and triangles, no edge is made
    /// twice, no two neighbours are folded onto each other, and no triangle intersects one that the old ones did not.
    void plan_removal(u32 vertex, Edit& edit);
    /// The flip of an edge: with the same conditions, and if it raises the least angle of the two triangles.
    void plan_flip(u32 half_edge, Edit& edit);

    /// Whether the new triangles intersect triangles that the old ones do not, among those of boxes changed at this
    /// stamp or later.
    bool intersects(const Edit& edit, u32 stamp);

    /// About the error of a vertex's removal, a length: the distance of the nearest ring vertex to the planes of the
    /// triangles at the vertex, root mean square by area. Infinite for vertices that stay.
    double estimate(u32 vertex);

private:
    /// A part of the hole: the whole one, or one side of a feature line.
    struct Side {
        std::vector<HoleCorner> corners;
        Vec3 up = Vec3::Zero();
        double angle_sine = 0;
        std::vector<u32> points;
        // For accumulated errors:
        bool is_height_field = true;  ///< over the plane across `up`, which the overlay needs
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
    std::vector<u32> ring_, star_;  ///< vertices; half-edges from the vertex
    std::vector<BoundingBox> boxes_;  ///< boxes of the planned triangles
    std::vector<u32> outside_;  ///< half-edges outside the hole's edges
    Side sides_[2];
    std::size_t side_count_ = 0;
    u32 line_ends_[2] = {};
    SignedErrors line_;
};

}  // namespace scanmill::decimating
