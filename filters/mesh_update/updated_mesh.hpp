// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The mesh of an update with its columns, and which of its triangles are new.

#include <memory>

#include "mesh_update/groups.hpp"
#include "mesh_update/rebuilt.hpp"

namespace scanmill::updating {

/// The triangles in which the model and the new mesh differ.
struct Difference {
    Array<u8> is_new;  ///< by triangle of the new mesh: 1 if no triangle of the model has its corners in its order
    Array<u32> old_facets;  ///< facets of the model that are not triangles of the new mesh, ascending
};

/// Rows of `rebuilt` below the number of the model's vertices are those vertices. Cost: a sort of the replaced facets.
Difference difference(const TriangleMesh& model, const Rebuilt& rebuilt);

/// `rebuilt` with the columns that MeshUpdateResult describes, after those of the model's vertices and of the clouds,
/// which are joined as merge() joins them. Sharp edges of the model that are edges of the result stay sharp; face
/// columns, edges and their columns are dropped, with a warning. `positions`: the model's, then those of all clouds.
TriangleMesh updated_mesh(const Model& model, std::span<const std::shared_ptr<const PointCloud>> clouds,
                          std::span<const Vec3> positions, const Groups& groups, const Rebuilt& rebuilt,
                          std::span<const u8> is_new, Context& context);

/// The given mesh with these columns. `model` is that mesh or what resampling made of it; `would_go`: by vertex of
/// `model`, the column `replaced`.
TriangleMesh kept_mesh(const TriangleMesh& given, const Model& model, const Groups& groups,
                       std::span<const u8> would_go, Context& context);

}  // namespace scanmill::updating
