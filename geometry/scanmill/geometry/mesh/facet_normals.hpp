// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Unit normals of a mesh's triangles, including those without area.

#include <span>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

struct FacetNormals {
    /// One per triangle. Zero for a triangle with a repeated vertex, and for all triangles of a connected component
    /// without area.
    Array<Vec3> unit;
    /// Triangles with a repeated vertex or a height below a billionth of their longest edge.
    std::size_t without_area = 0;
};

/// A triangle without area takes the normal of the neighbour across its longest edge; edges whose neighbour has no
/// normal are skipped. Among equally long edges, the lower normal by x, y, z is taken. Triangles beside proper ones
/// come first, then their neighbours. So a flat region triangulated with needles stays flat. At a crease, the long edge
/// of a needle is smooth, and its short edges are sharp.
///
/// Pre: finite positions; `opposite` is half_edges::opposites(mesh).
/// Post: no bit depends on the order of the triangles or vertices, nor on a triangle's first corner.
/// Cost: linear, 24 bytes per triangle.
FacetNormals facet_normals(const TriangleMesh& mesh, std::span<const u32> opposite, unsigned threads);

/// Tolerance of angle comparisons, in radians. An angle between normals that differs from a limit by at most this
/// counts as equal to the limit. The tolerance covers the rounding in the facets of a regular prism.
inline constexpr double angle_tie = 1e-9;

/// For each vertex the sum of area_vector() over its triangles.
Array<Vec3> vertex_area_vectors(const TriangleMesh& mesh);

}  // namespace scanmill
