// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Tells the outer boundaries of open surfaces from holes.

#include <vector>

#include "fill_holes/fill_holes.hpp"
#include "fill_holes/mesh_loops.hpp"

namespace scanmill {

struct OuterBoundaries {
    std::vector<bool> is_outer;  ///< by loop
    double share = 0;  ///< the flat areas of all outer boundaries, as a share of the area of the mesh
    double largest_share = 0;  ///< the same of the loop with the largest flat area
};

/// Finds the outer boundaries as FillHolesParams::Outer defines them. Cost: linear in the triangles.
OuterBoundaries outer_boundaries(const TriangleMesh& mesh, const MeshLoops& boundary, const FillHolesParams& params);

}  // namespace scanmill
