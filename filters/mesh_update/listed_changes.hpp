// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The list of an update's changes, and how far its new surface is from what was given.

#include "mesh_update/mesh_update.hpp"
#include "mesh_update/updated_mesh.hpp"

namespace scanmill::updating {

/// Sets changes and remeshed of the result, whose mesh is complete. A change contains a point of a cloud; other new
/// triangles are only counted. Cost: that of changes(), and a search in the model's tree for each point.
void list_changes(const Model& model, const Rebuilt& rebuilt, const Difference& difference, MeshUpdateResult& result,
                  Context& context);

/// The share of the new triangles' area that is farther than `distance` from the surfaces of the clouds and from these
/// facets of the model. A triangle is far if its centroid or the middle of an edge is. 0 without new triangles.
double far_share(const Model& model, std::span<const u32> facets, std::span<const CloudSurface* const> clouds,
                 const TriangleMesh& mesh, std::span<const u8> is_new, double distance, Context& context);

}  // namespace scanmill::updating
