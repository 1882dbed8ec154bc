// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The two faces at an edge, from the mesh round a point. The points of a thinned scan do not lie on its edges, so the
/// triangles that lead from one face to the other blunt an edge, and a line of sharp edges zigzags over them, in
/// directions that are not the edge's. The triangles whose corners all lie on one face still show that face.

#include <optional>

#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::probing {

struct EdgeFaces {
    Vec3 position;  ///< position on the edge, nearest to the point
    Vec3 tangent, left_normal, right_normal;  ///< unit vectors, the normals perpendicular to the tangent
};

/// The point of both planes { x : n · x = c } nearest to 0. Pre: the planes meet at an angle.
Vec3 nearest_on_both(const Vec3& n1, double c1, const Vec3& n2, double c2);

/// The mean length of the edges of the triangles within `radius`; 0 if there are none, or more than 1,000.
double mean_edge_near(const TriangleTree& mesh, const Vec3& point, double radius);

/// The edge of two planes through the triangles within `radius` of the point of `guess`; nothing where the normals of
/// `guess` explain these triangles as well, or no two planes do.
///
/// 1. Triangles are weighted by their area (at most radius²), falling to 0 at the distance `radius`. They are divided
///    in two along the direction in which their normals differ most.
/// 2. Each half has a plane: the mean normal, through the mean centre. A corner belongs to the plane that it is nearer
///    to, a triangle to a plane that all its corners belong to; other triangles are left out. This is repeated until
///    nothing changes, at most ten times (Bradley and Mangasarian 2000).
/// 3. Each plane is moved to where its face is at the edge, by a parabola along the edge: cylinders have curved edges.
/// 4. A pair of normals has a misfit: the mean over the triangles of min(1, (angle to the nearer normal / 15
///    degrees)²). The planes replace the guess if their misfit is smaller by more than that of a one-degree error. A
///    guess of one face, whose normals are equal, must also be halved: noise alone divides a face, too.
///
/// Where these planes meet at less than 10 degrees there is no edge: position and tangent are those of the guess, and
/// both normals are equal.
///
/// Triangles left out in step 2 whose normals are alike, across the edge, are a face of their own, such as a chamfer:
/// nothing then.
///
/// Nothing either where both faces are on one side of the edge, the edge is farther than `farthest` from the point, or
/// more than 1,000 triangles are near. Cost: a search, and linear in the triangles near.
std::optional<EdgeFaces> edge_faces(const TriangleTree& mesh, const EdgeFaces& guess, double radius, double farthest);

}  // namespace scanmill::probing
