// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The normals of the original surface at the corners of the new triangles.

#include "decimate/surface.hpp"
#include "scanmill/geometry/mesh/creases.hpp"

namespace scanmill::decimating {

/// Three components for each of the three corners of a triangle.
using CornerNormals = std::array<double, 9>;

/// For each triangle of surface.mesh().compact_triangles(), the unit normals of the sectors at its three corners.
///
/// A sector of a vertex is the group of its triangles between two consecutive feature edges. The normal of a sector is
/// the mean of the normals of its original triangles, weighted by their angles at the vertex. At vertices of creases,
/// unreliable triangles have the normals by which the creases were found: triangles that bridge a crease belong to one
/// of its sides, so the mean is the normal of this side. The remaining vertices keep their feature edges in order, so
/// the sectors of new and original triangles correspond. The normal is zero only at singular vertices, and where the
/// mean vanishes.
///
/// `creases`: of the original mesh. Cost: linear.
Array<CornerNormals> corner_normals(const Surface& surface, const TriangleMesh& original, std::span<const u32> opposite,
                                    const Creases& creases);

}  // namespace scanmill::decimating
