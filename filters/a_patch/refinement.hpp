// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Bisects edges of a mesh whose corners have normals.

#include "a_patch/hull.hpp"

namespace scanmill::a_patches {

/// Bisects the longest edge of each of the triangles; the longest of all come first (ties: by their vertices), and an
/// edge is left out if one of its triangles is cut already. The new vertex is the middle of the cubic through the ends
/// whose tangents there are the edge, projected to the tangent planes (as in Vlachos et al. 2001, "Curved PN
/// triangles"), or to the line where the two planes of a sharp edge meet; its normal is the mean of the ends', made
/// perpendicular to that cubic. A cut triangle keeps its row for the first part; the other parts are appended. Returns
/// how many edges were bisected: at least one, if there are triangles. Pre: an oriented manifold.
std::size_t bisect(PatchMesh& mesh, std::span<const u32> triangles);

/// Where the vertex that bisects an edge is.
enum class Middle {
    of_curve,   ///< middle of the cubic that bisect() describes
    of_segment  ///< between the ends, with the normals of the triangles
};

/// The same for edges.
std::size_t bisect_edges(PatchMesh& mesh, std::span<const Edge> edges, Middle middle);

}  // namespace scanmill::a_patches
