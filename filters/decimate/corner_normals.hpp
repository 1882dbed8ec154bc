// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The normals of the original surface at the corners of the new triangles.

#include "decimate/surface.hpp"

namespace scanmill::decimating {

/// Three components for each of the three corners of a triangle.
using CornerNormals = std::array<double, 9>;

/// By triangle of surface.mesh().compact_triangles(): at every corner the unit normal of its sector.
///
/// The sectors of a vertex are its triangles between consecutive feature edges; the normal of a sector is the mean of
/// the normals of the original triangles, weighted by their angles at the vertex. The vertices that are left keep their
/// feature edges in order, so the sectors of new and original triangles correspond. Zero where there is no normal: at
/// singular vertices, and in sectors with a triangle whose normal has a cosine below 0.1 with the mean.
///
/// `normals`: facet_normals() of the original mesh. Cost: linear.
Array<CornerNormals> corner_normals(const Surface& surface, const TriangleMesh& original, std::span<const u32> opposite,
                                    std::span<const Vec3> normals);

}  // namespace scanmill::decimating
