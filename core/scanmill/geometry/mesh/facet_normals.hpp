// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Unit normals of a mesh's triangles, those without area included, and the angle between two of them.

#include <span>

#include "scanmill/data/mesh.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill {

struct FacetNormals {
    /// One per triangle. Zero for a triangle that names a vertex twice, and where a piece of the mesh has no area.
    Array<Vec3> unit;
    /// Triangles that name a vertex twice or are thinner than a billionth of their longest side: they have no normal of
    /// their own.
    std::size_t without_area = 0;
};

/// A triangle without area takes the normal of the neighbour across its longest side that has one (of equally long
/// sides the one whose neighbour's normal is lower, by x, y, z), those beside proper triangles first. So a flat piece
/// that was triangulated with needles stays flat, and of a needle in a sharp edge the long side is smooth, the short
/// ones are sharp.
///
/// Pre: finite positions whose differences are numbers; `opposite` by half_edges::opposites.
/// Post: no bit depends on the order of the triangles or vertices, nor on which corner a triangle names first.
/// Cost: linear, 24 bytes per triangle.
FacetNormals facet_normals(const TriangleMesh& mesh, std::span<const u32> opposite, unsigned threads);

/// Angles between normals that differ from a limit by no more than this, in radians, count as equal to it: what
/// rounding does to the sides of a regular prism.
inline constexpr double angle_tie = 1e-9;

}  // namespace scanmill
