// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Normals at a mesh's corners, from the mesh or from points near it.

#include "a_patch/hull.hpp"

namespace scanmill::a_patches {

/// The corners of the triangles, grouped: those at one vertex whose triangles are connected there without crossing a
/// sharp edge or the boundary. In order of their first corner.
struct Sectors {
    std::vector<std::array<u32, 3>> of_corner;  ///< by triangle
    std::vector<u32> vertex;
    std::vector<bool> is_whole;  ///< whether no sharp edge ends at the vertex

    std::size_t size() const { return vertex.size(); }
};
Sectors sectors_of(const TriangleMesh& mesh);

/// The corners of every sector, as 3 * triangle + corner, ascending.
std::vector<std::vector<u32>> corners_of(const Sectors& sectors);

CornerNormals at_corners(const Sectors& sectors, std::span<const Vec3> normals);

/// For each sector, the sum over its triangles of (u x v) / (|u|² |v|²), scaled to length 1 unless it is 0; u and v are
/// the edges at the vertex. Exact for vertices on a sphere, unlike angle weights. Uses no function whose result depends
/// on the processor. Source: Max 1999, "Weights for computing vertex normals from facet normals".
std::vector<Vec3> mesh_normals(const TriangleMesh& mesh, const Sectors& sectors);

/// For each sector, the normal of a quadric through its vertex, fitted to the 25 nearest of the points and the other
/// vertices, turned to the side of `outwards`. At sharp edges only points count that are nearest to the sector's own
/// triangles; if there are fewer than 6, the sector keeps the normal of `outwards`.
std::vector<Vec3> point_normals(const TriangleMesh& mesh, const Sectors& sectors, std::span<const Vec3> points,
                                std::span<const Vec3> outwards, Execution& execution);

struct GivenNormals {
    std::vector<Vec3> normals;  ///< by sector, the mean of the column's; zero where it has none
    std::size_t several = 0;  ///< sectors with different normals
};
/// Reads the face column `corner-normals`. Throws Error if it is absent, has another shape, or a number is not finite.
GivenNormals given_normals(const TriangleMesh& mesh, const Sectors& sectors);

/// The unit vector whose least cosine with the normals is greatest. Pre: at least one; unit
/// length. Cost: about linear.
Vec3 most_normal(std::span<const Vec3> normals);

}  // namespace scanmill::a_patches
