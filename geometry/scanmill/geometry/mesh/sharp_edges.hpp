// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds the sharp edges of a mesh, by their angle or by the mesh's declaration.

#include <span>
#include <vector>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// For each half-edge (see half_edges.hpp), whether its edge is one of the mesh's declared sharp edges. Opposite
/// half-edges have equal values. No boundary edge is sharp.
///
/// Pre: `opposite` is half_edges::opposites(mesh). Throws Error for a declared sharp edge that is in no triangle. Cost:
/// linear, plus a sort of the declared edges; one bit per half-edge.
std::vector<bool> declared_sharp_half_edges(const TriangleMesh& mesh, std::span<const u32> opposite);

/// For each half-edge, whether its edge is sharp. An edge is *sharp* if the normals of its two triangles differ by more
/// than `sharp_angle`, in radians, or if it is one of the mesh's declared sharp edges. Opposite half-edges have equal
/// values. No boundary edge is sharp.
///
/// Pre: `opposite` is half_edges::opposites(mesh); `normals` are the result of facet_normals(). Throws Error where
/// declared_sharp_half_edges() does. Cost: linear, one bit per half-edge.
std::vector<bool> sharp_half_edges(const TriangleMesh& mesh, std::span<const u32> opposite,
                                   std::span<const Vec3> normals, double sharp_angle, unsigned threads);

}  // namespace scanmill
