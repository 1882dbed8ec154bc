// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Normals at a mesh's corners, from the mesh or from points near it.

#include "a_patch/hull.hpp"

namespace scanmill::a_patches {

/// The corners of the triangles, grouped into sectors. Two corners at one vertex are in one sector if their triangles
/// are connected there without crossing a sharp edge or the boundary. Sectors are ordered by their first corner.
struct Sectors {
    std::vector<std::array<u32, 3>> of_corner;  ///< by triangle: the sectors of its corners
    std::vector<u32> vertex;  ///< by sector
    std::vector<bool> is_whole;  ///< by sector: whether no sharp edge ends at its vertex

    std::size_t size() const { return vertex.size(); }
};
Sectors sectors_of(const TriangleMesh& mesh);

/// The corners of every sector, as 3 * triangle + corner, ascending.
std::vector<std::vector<u32>> corners_of(const Sectors& sectors);

CornerNormals at_corners(const Sectors& sectors, std::span<const Vec3> normals);

/// For each sector, the sum over its triangles of (u x v) / (|u|² |v|²), where u and v are the edges at the vertex. The
/// sum is scaled to length 1 unless it is 0. It is exact for vertices on a sphere, unlike sums with angle weights. The
/// code uses no function whose result depends on the processor. Source: Max 1999, "Weights for computing vertex normals
/// from facet normals".
std::vector<Vec3> mesh_normals(const TriangleMesh& mesh, const Sectors& sectors);

/// For each sector, the normal of a quadric through its vertex, turned to the side of `outwards`. The quadric is fitted
/// to the 25 nearest of the points and the other vertices. At sharp edges, only points whose nearest triangle belongs
/// to the sector count. If fewer than 6 count, the sector gets its normal of `outwards`.
std::vector<Vec3> point_normals(const TriangleMesh& mesh, const Sectors& sectors, std::span<const Vec3> points,
                                std::span<const Vec3> outwards, Execution& execution);

struct GivenNormals {
    std::vector<Vec3> normals;  ///< by sector: the mean of the column's normals; zero if the column has none there
    std::size_t several = 0;  ///< number of sectors whose corners have different normals
};
/// Reads the face column `corner-normals`. Throws Error if it is absent, has another shape, or contains a number that
/// is not finite.
GivenNormals given_normals(const TriangleMesh& mesh, const Sectors& sectors);

/// The unit vector whose smallest cosine with the normals is greatest. Pre: at least one normal; all have unit length.
/// Cost: about linear.
Vec3 most_normal(std::span<const Vec3> normals);

}  // namespace scanmill::a_patches
