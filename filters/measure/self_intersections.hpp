// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Counts the pairs of a mesh's triangles that meet where they should not.

#include "scanmill/data/mesh.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

/// Pairs of triangles with a point in common beyond their common vertices and edge. Touching counts: a corner that lies
/// on another triangle, an edge on an edge, overlapping in a plane, the same triangle twice. Vertices at one position
/// count as one vertex, so a soup is judged as the mesh that it draws. Collinear triangles are passed over (they are
/// counted in MeshNumbers). Decided by exact predicates.
///
/// Pre: `tree` is over exactly these positions and triangles. Any number of threads counts the same.
/// Cost: O(F log F) plus one test for each pair of overlapping boxes.
/// Source: the cases are those of CGAL's Polygon_mesh_processing::self_intersections, on a soup.
std::size_t count_self_intersections(const TriangleMesh& mesh, const TriangleTree& tree, Context& context);

}  // namespace scanmill
