// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds the two faces at an edge from the mesh around a point. The points of a thinned scan do not lie on the edges of
/// the part. Triangles that lead from one face to the other therefore blunt an edge. A line of sharp edges zigzags over
/// these triangles, in directions that are not the edge's. Triangles whose corners all lie on one face still show that
/// face.

#include <optional>

#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::probing {

struct EdgeFaces {
    Vec3 position;  ///< position on the edge, nearest to the point
    Vec3 tangent, left_normal, right_normal;  ///< unit vectors, the normals perpendicular to the tangent
};

/// Returns the point nearest to 0 that is in both planes { x : n · x = c }. Pre: unit normals; the planes are not
/// parallel.
Vec3 nearest_on_both(const Vec3& n1, double c1, const Vec3& n2, double c2);

/// Mean edge length of the triangles within `radius` of the point; 0 if there are none, or more than 1,000.
double mean_edge_near(const TriangleTree& mesh, const Vec3& point, double radius);

/// Returns the edge of two planes that fit the triangles within `radius` of the point of `guess`. Empty if the normals
/// of `guess` explain these triangles as well, or if no two planes do.
///
/// 1. Triangles are weighted by their area (at most radius²). The weight falls to 0 at the distance `radius`. The
///    triangles are divided in two along the direction in which their normals differ most.
/// 2. Each half has a plane with its mean normal through its mean centre. A corner belongs to the nearer plane. A
///    triangle belongs to a plane if all its corners do; other triangles are left out. This step is repeated until
///    nothing changes, at most ten times (Bradley and Mangasarian 2000).
/// 3. Each plane is moved to the height of its face at the edge. A parabola along the edge determines this height,
///    since cylinders have curved edges.
/// 4. The misfit of a pair of normals is the mean over the triangles of min(1, (angle to the nearer normal / 15
///    degrees)²). The planes replace the guess if their misfit is smaller by more than that of a one-degree error. If
///    the guess is one face, with equal normals, the misfit must also be less than half: noise alone divides a face,
///    too.
///
/// If these planes meet at less than 10 degrees, there is no edge. Position and tangent are then those of the guess,
/// and both normals are equal.
///
/// If the triangles left out in step 2 have similar normals across the edge, they are a face of their own, such as a
/// chamfer. The result is then empty.
///
/// The result is also empty if both faces are on one side of the edge, if the edge is farther than `farthest` from the
/// point, or if more than 1,000 triangles are near. Cost: a search, and linear in the triangles near.
std::optional<EdgeFaces> edge_faces(const TriangleTree& mesh, const EdgeFaces& guess, double radius, double farthest);

}  // namespace scanmill::probing
