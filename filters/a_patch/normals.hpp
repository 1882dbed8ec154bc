// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Normals of a mesh's vertices, from the mesh or from points near it.

#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill::a_patches {

/// Of every vertex: the sum over its triangles of (u x v) / (|u|² |v|²), u and v being the edges at the vertex; unit
/// length. Exact for vertices on a sphere, unlike angle weights, and needs no function whose result depends on the
/// processor. Zero for unused vertices, and where the sum is. Source: Max 1999, "Weights for computing vertex normals
/// from facet normals".
std::vector<Vec3> mesh_normals(const TriangleMesh& mesh);

/// Of every vertex: that of a quadric through it, fitted to the 25 nearest of the points and other vertices; on the
/// side of `outwards`.
std::vector<Vec3> point_normals(const TriangleMesh& mesh, std::span<const Vec3> points, std::span<const Vec3> outwards,
                                Execution& execution);

struct GivenNormals {
    std::vector<Vec3> normals;    ///< the mean of the column's; zero where it has none
    std::size_t several = 0;      ///< vertices with different normals
};
/// Of the face column `corner-normals`. Throws Error if it is absent, has another shape, or a number is not finite.
GivenNormals given_normals(const TriangleMesh& mesh);

/// The unit vector whose least cosine with the normals is greatest. Pre: at least one.
Vec3 most_normal(std::span<const Vec3> normals);

}  // namespace scanmill::a_patches
