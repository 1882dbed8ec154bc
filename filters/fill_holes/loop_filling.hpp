// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Fills one loop of a mesh with CGAL, in a mesh that contains only the triangles around the loop.

#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// The triangles that have a vertex of a loop. From them CGAL computes edge lengths and normals at the loop.
struct LoopSurroundings {
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    /// By half-edge 3 t + i (see half_edges.hpp): the opposite half-edge, or half_edges::boundary.
    std::vector<u32> opposite;
    /// For each half-edge on the boundary, the previous half-edge along the boundary.
    std::vector<u32> before_on_boundary;
    /// A half-edge of the loop.
    u32 loop = 0;
};

/// Stages of a hole triangulation. `avoiding`: the triangles of least area that do not intersect the mesh, see
/// Conflicts::least_triangulation().
enum class FillingStage { avoiding, triangulated, refined, faired };

struct LoopFilling {
    /// Positions of the new vertices, inside the loop.
    std::vector<Vec3> positions;
    /// Empty if CGAL finds no triangulation. Indices below #surroundings.positions are vertices of the surroundings.
    /// Higher ones are rows of `positions`, plus that number.
    std::vector<Triangle> triangles;
};

/// Pre: every vertex of the surroundings has one cycle of triangles and gaps; stage is not `avoiding`. Throws
/// Cancelled. If fairing fails, the result is empty.
LoopFilling fill_loop(const LoopSurroundings& surroundings, FillingStage stage, const Execution& execution);

}  // namespace scanmill
