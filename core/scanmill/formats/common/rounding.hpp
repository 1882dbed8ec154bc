// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Helpers for writers of meshes that round coordinates: a shift that makes the rounding harmless, and the vertices
/// that rounding joins.
///
/// Floats hold a mesh if no two different positions are rounded to the same position and no edge is distorted: the
/// movements of its two ends add up to at most a hundredth of its length. A triangle without angles below one degree
/// then keeps its orientation. 24 bits of mantissa suffice for any usual mesh near zero. Far from zero, at survey
/// coordinates, they do not.

#include <functional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/formats/common/format.hpp"

namespace scanmill {

/// The number rounded to single precision. The vectoriser of GCC 12.2 drops conversions of several numbers to float and
/// back, so `static_cast<double>(static_cast<float>(x))` is not safe.
double rounded_to_float(double number);
inline Vec3 rounded_to_float(const Vec3& p) {
    return {rounded_to_float(p.x()), rounded_to_float(p.y()), rounded_to_float(p.z())};
}

/// The shift to subtract from world coordinates before they are rounded to float. Zero if floats hold the mesh, or if
/// the mesh is not far from zero. Else the shift is the middle of the mesh, rounded to multiples of a power of ten,
/// along every axis whose coordinates exceed 16 diagonals. The power is the largest within 1000 diagonals for which
/// floats hold the shifted mesh. If there is none, it is the largest within one diagonal, and shifted coordinates are
/// at most one diagonal.
/// Pre: finite floats can hold all coordinates. Cost: O(V + F); for a mesh near zero, only the box is computed.
Vec3 shift_for_floats(const TriangleMesh& mesh);

/// "500000 4500000 300".
std::string shift_text(const Vec3& shift);

/// Vertices that are written at equal positions.
struct JoinedVertices {
    Array<u32> numbers;  ///< number of each vertex, from 0 without gaps; equal for vertices at equal written positions
    Array<Vec3> positions;  ///< written positions, indexed by number
    u64 rounded = 0;  ///< vertices that only the rounding puts at the position of an earlier vertex
    u64 equal = 0;  ///< vertices that are at the position of an earlier vertex in the mesh, too
};
/// `written` returns the position of a vertex in the file. All its numbers are doubles.
JoinedVertices joined_vertices(const TriangleMesh& mesh, const std::function<Vec3(std::size_t vertex)>& written);

/// The number of triangles with two corners that are at different positions in the mesh and at equal positions in the
/// file.
u64 collapsed_triangles(const TriangleMesh& mesh, const JoinedVertices& joined);

/// The triangles to write in a format without vertex numbers, whose readers join equal positions. These are all
/// triangles except the collapsed ones. Warns about the collapsed triangles. Calls WriteOptions::on_opened, or warns,
/// if the file is not closed although the mesh is. Throws Error if every triangle has two corners at one position.
Buffer<Triangle> triangles_of_positions(const TriangleMesh& mesh, const JoinedVertices& joined, std::string_view format,
                                        const WriteOptions& options);

/// Warns about the triangles that collapse in a format with vertex numbers. Such a format keeps the topology.
void warn_collapsed(const TriangleMesh& mesh, const JoinedVertices& joined, std::string_view format,
                    const WriteOptions& options);

}  // namespace scanmill
