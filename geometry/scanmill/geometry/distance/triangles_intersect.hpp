// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether two triangles of a mesh intersect, decided exactly for the coordinates as they are.

#include <span>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// Whether the points are on one line; equal points are.
/// Pre: finite coordinates below 1e40. Cost: a few nanoseconds, unless the points are nearly on a line.
bool collinear(const Vec3& a, const Vec3& b, const Vec3& c);

/// Whether the triangles have a point in common beyond their common corners and edge. Corners are common if their
/// indices are equal; corners with equal positions are not.
///
/// What counts: crossing; touching, such as a corner of one on the face, an edge or a corner of the other; overlapping
/// in one plane; of triangles with a common edge, one folded flat onto the other; the same three corners twice, in any
/// order. Collinear triangles, also those with a repeated index, intersect nothing.
///
/// Pre: finite coordinates below 1e40. The order of the triangles and of their corners does not matter.
/// Cost: about 30 ns where rounded arithmetic finds a plane between the triangles, which it does for nearly all pairs
/// of a mesh that does not intersect itself; some microseconds at most otherwise.
/// Source: the cases are those of CGAL's Polygon_mesh_processing::self_intersections.
bool triangles_intersect(std::span<const Vec3> positions, const Triangle& one, const Triangle& other);

}  // namespace scanmill
