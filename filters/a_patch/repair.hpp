// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Changes normals and sharp edges of a mesh where no hull, or no crease, can follow it.

#include "a_patch/hull.hpp"

namespace scanmill::a_patches {

struct Repairs {
    std::size_t replaced = 0;  ///< normals
    std::size_t bisected = 0;  ///< edges
    std::size_t creased = 0;   ///< edges made sharp
    std::size_t smoothed = 0;  ///< sharp edges made smooth
    std::size_t pointed = 0;  ///< vertices
    std::size_t straightened = 0;  ///< edges made sharp and straight
};

std::vector<Vec3> triangle_normals(const TriangleMesh& mesh);

/// The normals of the triangles that have these corners.
std::vector<Vec3> normals_at(std::span<const u32> corners, std::span<const Vec3> of_triangles);

/// Whether the direction is more than 84 degrees from one of the normals.
bool opposes(const Vec3& direction, std::span<const Vec3> normals);

/// Replaces normals that oppose a triangle, by that of the mesh or the direction nearest to all triangles of the
/// sector. Where no direction suits all, the sector's most acute edges become sharp, until one does (ties: by their
/// vertices).
void replace_opposing(PatchMesh& mesh, Repairs& repairs);

/// Makes the normal of a sector perpendicular to the one or two sharp edges at its sides, where it almost is, and it is
/// much more so than that of the other sides: then a plane face meets a curved one in a curve of the plane, and two
/// planes in a straight line. Rounding would make the plane cross the chord of the curve.
void level_normals(PatchMesh& mesh);

/// Gives the corners of the triangles the direction nearest to all their triangles' normals.
void turn_normals(PatchMesh& mesh, std::span<const u32> triangles, Repairs& repairs);

/// Turns the normals at the ends of these sharp edges so that creases follow the edges: perpendicular to the chain of
/// two sharp edges, to a last sharp edge, and at corners to the two edges of every sector, unless a triangle opposes
/// that.
void align_normals(PatchMesh& mesh, std::span<const Edge> edges, Repairs& repairs);

/// Makes those of the sharp edges smooth whose triangles' normals differ by less than 30 degrees, or the normals on
/// both sides at both ends; their ends get the mean of the normals. Returns how many.
std::size_t smooth_edges(PatchMesh& mesh, std::span<const Edge> edges, Repairs& repairs);

/// Makes the ends of the edges and the corners of the triangles pointed. Edges and sides of triangles where all
/// vertices are so already become sharp: the surface follows the mesh there, because sharp edges between pointed
/// vertices are straight, and a triangle with three of them is flat. Returns whether something has changed.
bool loosen(PatchMesh& mesh, std::span<const Edge> edges, std::span<const u32> triangles, Repairs& repairs);

}  // namespace scanmill::a_patches
