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
    std::size_t opened = 0;  ///< number of edges made open, except those of flat triangles
    std::size_t flattened = 0;  ///< number of triangles made flat
};

std::vector<Vec3> triangle_normals(const TriangleMesh& mesh);

/// The normals of the triangles that have these corners.
std::vector<Vec3> normals_at(std::span<const u32> corners, std::span<const Vec3> of_triangles);

/// Whether the direction is more than 84 degrees from one of the normals.
bool opposes(const Vec3& direction, std::span<const Vec3> normals);

/// Turns each normal more than 73 degrees from that of a triangle towards it. If it still opposes a triangle, the
/// normal of the mesh replaces it, or the direction nearest to the normals of all triangles of the sector. Where no
/// direction suits all of them, the sector's most acute edges become sharp until one does (ties: by their vertices).
void replace_opposing(PatchMesh& mesh, Repairs& repairs);

/// Makes a sector's normal perpendicular to the one or two sharp edges at its sides if a turn of at most 2 degrees
/// suffices. Each edge sets a condition: the normal is almost perpendicular to it, or much closer to perpendicular than
/// the normal beyond the edge. Then a plane face meets a curved face in a plane curve, and another plane face in a
/// straight line. Without this, rounding would make the plane cross the chord of the curve.
void level_normals(PatchMesh& mesh);

/// Makes sharp edges smooth whose sides agree: the normals on the two sides differ by less than 30 degrees at both
/// ends. Such an edge stays within a line of sharp edges that continues to edges whose sides do not agree. The vertices
/// get the mean of the normals.
void smooth_agreeing_edges(PatchMesh& mesh, Repairs& repairs);

/// Moves vertices of a triangle that bisection has put beside an edge to the middle of the edge, so that the triangle
/// lies in the mesh as it was. Returns whether one has moved.
bool move_back(PatchMesh& mesh, u32 triangle);

/// Makes the surface follow the mesh: the edges become sharp and open, and the triangles flat.
void follow_mesh(PatchMesh& mesh, std::span<const Edge> edges, std::span<const u32> triangles, Repairs& repairs);

}  // namespace scanmill::a_patches
