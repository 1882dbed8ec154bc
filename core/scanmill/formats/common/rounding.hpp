// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// For writers of meshes that round coordinates: a shift that keeps them exact enough, and what rounding joins.
///
/// A format with single precision holds a mesh if no two vertices at different positions are rounded to the same one,
/// and no edge has ends that move, added, by more than a hundredth of its length: a triangle without angles below one
/// degree then keeps its orientation. 24 bits of mantissa suffice for any usual mesh near zero; far from zero, at
/// survey coordinates, they do not.

#include <functional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/formats/common/format.hpp"

namespace scanmill {

/// The number as single precision holds it. The vectoriser of GCC 12.2 drops conversions of several numbers to float
/// and back, so `static_cast<double>(static_cast<float>(x))` is not safe.
double rounded_to_float(double number);
inline Vec3 rounded_to_float(const Vec3& p) {
    return {rounded_to_float(p.x()), rounded_to_float(p.y()), rounded_to_float(p.z())};
}

/// The shift to subtract from world coordinates before they are rounded to float. Zero if floats hold the mesh, or it
/// is not far from zero. Else, on every axis whose coordinates exceed 16 diagonals, the multiple of a power of ten that
/// is nearest to the mesh's middle. The power is the largest within 1000 diagonals for which floats hold the shifted
/// mesh, and at least the largest within one diagonal: shifted coordinates are then at most one diagonal.
/// Pre: finite floats can hold all coordinates. Cost: O(V + F), nothing but the box for a mesh near zero.
Vec3 shift_for_floats(const TriangleMesh& mesh);

/// "500000 4500000 300".
std::string shift_text(const Vec3& shift);

/// Vertices that are written at equal positions.
struct JoinedVertices {
    Array<u32> numbers;  ///< number of each vertex; equal for vertices written at equal positions, from 0 without gaps
    Array<Vec3> positions;  ///< as written, by number
    u64 rounded = 0;  ///< vertices written at the position of an earlier one that is elsewhere in the mesh
    u64 equal = 0;  ///< vertices at the position of an earlier one, also in the mesh
};
/// `written`: the position of a vertex in the file, of which every number is a double.
JoinedVertices joined_vertices(const TriangleMesh& mesh, const std::function<Vec3(std::size_t vertex)>& written);

/// Triangles two of whose corners differ in the mesh and are equal as written.
u64 collapsed_triangles(const TriangleMesh& mesh, const JoinedVertices& joined);

/// For formats without vertex numbers, whose readers join equal positions: the triangles to write, which are all but
/// the collapsed ones. Warns of these. Calls WriteOptions::on_opened, or warns, if the file is not closed although
/// the mesh is. Throws Error if every triangle has two corners at one position.
Buffer<Triangle> triangles_of_positions(const TriangleMesh& mesh, const JoinedVertices& joined, std::string_view format,
                                        const WriteOptions& options);

/// For formats with vertex numbers, whose topology stays: warns of the triangles that collapse.
void warn_collapsed(const TriangleMesh& mesh, const JoinedVertices& joined, std::string_view format,
                    const WriteOptions& options);

}  // namespace scanmill
