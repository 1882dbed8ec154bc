// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Which edges of a mesh are sharp: by their angle, or because the mesh declares them.

#include <span>
#include <vector>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// By half-edge (see half_edges.hpp): whether its edge is one of the mesh's declared sharp edges. Opposite half-edges
/// are equal; no edge on the boundary is sharp.
///
/// Pre: `opposite` by half_edges::opposites(). Throws Error for a declared sharp edge that is in no triangle. Cost:
/// linear but for a sort of the declared edges; one bit per half-edge.
std::vector<bool> declared_sharp_half_edges(const TriangleMesh& mesh, std::span<const u32> opposite);

/// By half-edge: whether its edge is sharp. An edge is *sharp* if the normals of its two triangles
/// differ by more than `sharp_angle`, in radians, or if it is one of the mesh's declared sharp edges. Opposite
/// half-edges are equal; no edge on the boundary is sharp.
///
/// Pre: `opposite` by half_edges::opposites(), `normals` by facet_normals(). Throws Error as
/// declared_sharp_half_edges(). Cost: linear, one bit per half-edge.
std::vector<bool> sharp_half_edges(const TriangleMesh& mesh, std::span<const u32> opposite,
                                   std::span<const Vec3> normals, double sharp_angle, unsigned threads);

}  // namespace scanmill
