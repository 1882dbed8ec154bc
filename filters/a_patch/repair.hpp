// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Changes normals and sharp edges of a mesh where no hull, or no crease, can follow it.

#include "a_patch/hull.hpp"

namespace scanmill::a_patches {

struct Repairs {
    std::size_t replaced = 0;  ///< number of normals replaced
    std::size_t bisected = 0;  ///< number of edges bisected
    std::size_t creased = 0;   ///< number of edges made sharp
    std::size_t smoothed = 0;  ///< number of sharp edges made smooth
    std::size_t pointed = 0;  ///< number of vertices with a tip
    std::size_t straightened = 0;  ///< number of edges made sharp and straight
};

std::vector<Vec3> triangle_normals(const TriangleMesh& mesh);

/// The normals of the triangles that have these corners.
std::vector<Vec3> normals_at(std::span<const u32> corners, std::span<const Vec3> of_triangles);

/// Whether the direction is more than 84 degrees from one of the normals.
bool opposes(const Vec3& direction, std::span<const Vec3> normals);

/// Replaces each normal that opposes a triangle by the normal of the mesh, or by the direction nearest to the normals
/// of all triangles of the sector. Where no direction suits all of them, the sector's most acute edges become sharp
/// until one does (ties: by their vertices).
void replace_opposing(PatchMesh& mesh, Repairs& repairs);

/// Makes a sector's normal perpendicular to the one or two sharp edges at its sides if a turn of at most 2 degrees
/// suffices. Each edge sets a condition: the normal is almost perpendicular to it, or much closer to perpendicular than
/// the normal beyond the edge. Then a plane face meets a curved face in a plane curve, and another plane face in a
/// straight line. Without this, rounding would make the plane cross the chord of the curve.
void level_normals(PatchMesh& mesh);

/// Sets each normal at the triangles' corners to the direction nearest to the normals of all triangles of its sector.
void turn_normals(PatchMesh& mesh, std::span<const u32> triangles, Repairs& repairs);

/// Turns the normals at the ends of these sharp edges so that creases follow the edges. If a sector has one sharp edge,
/// its normal becomes perpendicular to that edge. If it has two, its normal becomes perpendicular to the chain of the
/// two edges, or, at a corner with more sharp edges, to each of the two. A normal stays if a triangle opposes the new
/// one.
void align_normals(PatchMesh& mesh, std::span<const Edge> edges, Repairs& repairs);

/// Makes a sharp edge smooth if the normals of its triangles differ by less than 30 degrees, or if at both ends the
/// normals on its two sides differ by less than that. The ends get the mean of the normals. Returns the number of edges
/// made smooth.
std::size_t smooth_edges(PatchMesh& mesh, std::span<const Edge> edges, Repairs& repairs);

/// Makes the ends of the edges and the corners of the triangles pointed. If all of these vertices are pointed already,
/// the edge, or the sides of the triangle, become sharp. The surface then follows the mesh, because a sharp edge
/// between pointed vertices is straight, and a triangle with three such edges is flat. Returns whether something has
/// changed.
bool loosen(PatchMesh& mesh, std::span<const Edge> edges, std::span<const u32> triangles, Repairs& repairs);

}  // namespace scanmill::a_patches
