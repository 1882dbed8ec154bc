// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Properties of one mesh by itself: size, topology, the shape of its triangles, self-intersections.

#include <optional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/mesh/topology.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

struct MeshNumbers {
    MeshTopology topology;
    double area = 0;
    /// By the divergence theorem: positive if triangles are counter-clockwise from outside. Absent unless closed.
    std::optional<double> volume;
    /// Triangles whose corners are on one line, decided exactly.
    std::size_t collinear_triangles = 0;
    /// Of every triangle's smallest angle, in radians: least, 5 % and 50 % quantile. Collinear triangles have 0.
    double least_angle = 0, angle_p5 = 0, angle_p50 = 0;
    /// Longest edge over 2 √3 inradii: 1 for an equilateral triangle. Collinear triangles do not count.
    double aspect_p50 = 1, aspect_p95 = 1, largest_aspect = 1;
};

/// Pre: consistent, finite coordinates. Bytes do not depend on the number of threads. Cost: O(F log F).
MeshNumbers mesh_numbers(const TriangleMesh& mesh, unsigned threads);

/// Pairs of triangles with a point in common beyond their common vertices and edge. Touching counts: a corner on
/// another triangle, an edge on an edge, overlap in a plane, the same triangle twice. Vertices at one position count as
/// one vertex, so a soup has the pairs of the mesh that it draws. Collinear triangles are skipped (MeshNumbers counts
/// them). Decided by exact predicates.
///
/// Pre: `tree` is over exactly these positions and triangles. The count does not depend on the number of threads.
/// Cost: O(F log F) plus one test for each pair of overlapping boxes.
/// Source: the cases are those of CGAL's Polygon_mesh_processing::self_intersections, on a soup.
std::size_t count_self_intersections(const TriangleMesh& mesh, const TriangleTree& tree, Context& context);

namespace measuring {

/// Smallest angle of a triangle with these corners, in radians; 0 if one of its edges has no length.
double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace measuring

}  // namespace scanmill
