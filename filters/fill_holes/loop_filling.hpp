// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// One loop of a mesh filled by CGAL, apart from the rest of the mesh.

#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// The triangles around a loop: all that have a vertex of the loop, so that CGAL finds the lengths and normals there.
struct LoopSurroundings {
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    /// By half-edge 3 t + i (see half_edges.hpp): the opposite one, or half_edges::boundary.
    std::vector<u32> opposite;
    /// By half-edge on the boundary: the one before it along the boundary.
    std::vector<u32> before_on_boundary;
    /// A half-edge of the loop.
    u32 loop = 0;
};

/// Stages of a hole triangulation. `avoiding`: the triangles of least area that do not intersect the mesh, see
/// Conflicts::least_triangulation().
enum class FillingStage { avoiding, triangulated, refined, faired };

struct LoopFilling {
    /// Inside the loop.
    std::vector<Vec3> positions;
    /// Empty if CGAL finds none. Indices below #surroundings.positions are vertices of the surroundings; others, less
    /// that number, of `positions`.
    std::vector<Triangle> triangles;
};

/// Pre: every vertex of the surroundings has one cycle of triangles and gaps; stage is not `avoiding`. Throws
/// Cancelled. If fairing fails, the result is empty.
LoopFilling fill_loop(const LoopSurroundings& surroundings, FillingStage stage, const Execution& execution);

}  // namespace scanmill
