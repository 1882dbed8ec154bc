// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Unit normals of a mesh's triangles, including those without area.

#include <span>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

struct FacetNormals {
    /// One per triangle. Zero for a triangle with a repeated vertex, and in a connected component without area.
    Array<Vec3> unit;
    /// Triangles with a repeated vertex or a height below a billionth of their longest edge.
    std::size_t without_area = 0;
};

/// A triangle without area takes the normal of a neighbour: across the longest edge whose neighbour has a normal (of
/// equally long edges, the lower normal by x, y, z). Triangles beside proper ones come first, then their neighbours.
/// So a flat region triangulated with needles stays flat; the long edge of a needle at a crease is smooth, its short
/// edges are sharp.
///
/// Pre: finite positions; `opposite` by half_edges::opposites().
/// Post: no bit depends on the order of the triangles or vertices, nor on a triangle's first corner.
/// Cost: linear, 24 bytes per triangle.
FacetNormals facet_normals(const TriangleMesh& mesh, std::span<const u32> opposite, unsigned threads);

/// In radians. Angles between normals that differ from a limit by at most this count as equal to it: it covers the
/// rounding in the facets of a regular prism.
inline constexpr double angle_tie = 1e-9;

/// For each vertex the sum of area_vector() over its triangles.
Array<Vec3> vertex_area_vectors(const TriangleMesh& mesh);

}  // namespace scanmill
