// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Bisects edges of a mesh whose corners have normals.

#include "a_patch/hull.hpp"

namespace scanmill::a_patches {

/// Bisects the longest edge of each of the triangles, the longest edges first (ties: by their vertices). An edge is
/// left out if one of its triangles is already cut. A cut triangle keeps its row for the first part; the other part is
/// appended. Returns the number of bisected edges: at least one, if there are triangles. Pre: an oriented manifold.
///
/// The new vertex is the middle of a cubic curve through the edge's ends. The curve's tangent at an end is the edge,
/// projected to the tangent plane (as in Vlachos et al. 2001, "Curved PN triangles"). At a sharp edge it is projected
/// to the line in which the two tangent planes meet. The new normal is the mean of the ends' normals, made
/// perpendicular to the curve. If a part of a triangle would turn too
/// far, the vertex is the middle of the edge, with the normals of the triangles.
std::size_t bisect(PatchMesh& mesh, std::span<const u32> triangles);

/// Bisects edges like bisect(). Edges that are not in the mesh are skipped.
std::size_t bisect_edges(PatchMesh& mesh, std::span<const Edge> edges);

}  // namespace scanmill::a_patches
