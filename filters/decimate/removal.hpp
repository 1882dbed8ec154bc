// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Plans the removal of one vertex: finds the triangulation of the hole, and whether it keeps all limits.

#include "decimate/hole.hpp"

namespace scanmill::decimating {

class Planner {
public:
    Planner(const Surface& surface, const Limits& limits) : surface_(surface), limits_(limits) {}

    /// Reads the surface only, so several planners may work at the same time.
    void plan(u32 vertex, Removal& removal);
    /// Plans the flip of an edge, if it raises the least angle of the two triangles.
    void plan_flip(u32 half_edge, Removal& flip);
    /// Estimate of the error that the removal of the vertex makes: a length; infinite for vertices that stay.
    double estimate(u32 vertex);
    /// Whether the planned triangles intersect others whose boxes changed at this stamp or later.
    bool intersects(const Removal& removal, u32 stamp);

private:
    bool flip_intersects(u32 half_edge, const Triangle (&planned)[2], u32 stamp) const;
    bool find_holes(u32 vertex);
    bool add_line_errors(u32 vertex, u32 a, u32 b, const Vec3& up, SignedErrors& errors) const;
    bool folds(u32 vertex, const Removal& removal) const;

    const Surface& surface_;
    const Limits& limits_;
    std::vector<u32> ring_;
    std::vector<u32> star_;  ///< half-edges from the vertex
    Hole holes_[2];
    std::size_t hole_count_ = 0;
    u32 line_ends_[2] = {0, 0};  ///< vertices
};

}  // namespace scanmill::decimating
