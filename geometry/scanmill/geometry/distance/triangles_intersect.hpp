// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Decides whether two triangles of a mesh intersect, exactly for the coordinates as given.

#include <span>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// Whether the points are on one line. Equal points are on one line.
/// Pre: finite coordinates below 1e40. Cost: a few nanoseconds, unless the points are nearly on a line.
bool collinear(const Vec3& a, const Vec3& b, const Vec3& c);

/// Whether the triangles have a point in common besides their common corners and edge. Corners are common if their
/// indices are equal; equal positions are not sufficient.
///
/// These cases count as intersections:
/// - crossing;
/// - touching, such as a corner of one triangle on the face, an edge or a corner of the other;
/// - overlapping in one plane;
/// - triangles with a common edge, if one is folded flat onto the other;
/// - the same three corners twice, in any order.
///
/// Collinear triangles intersect nothing. This includes triangles with a repeated index.
///
/// Pre: finite coordinates below 1e40. The order of the triangles and of their corners does not matter.
/// Cost: about 30 ns if rounded arithmetic finds a plane between the triangles, otherwise some microseconds at most.
/// Rounded arithmetic finds a plane for nearly all pairs of a mesh that does not intersect itself.
/// Source: the cases agree with CGAL's Polygon_mesh_processing::self_intersections.
bool triangles_intersect(std::span<const Vec3> positions, const Triangle& one, const Triangle& other);

}  // namespace scanmill
