// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds the edges of patches, where a sharp edge ends the growth. Sets the sharp edges of the mesh and the normals
/// beyond them.

#include "region_grow/suitable_point.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/growing/finished_mesh.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"

namespace scanmill::growing {

/// A boundary edge at which the surface continues in another patch.
struct PatchEdge {
    u32 from, to;
    /// The point of the other patch that the edge would have chosen first.
    u32 beyond;
};

/// Finds the boundary edges where only the angle ended the patch. A boundary point there, not a neighbour of the edge's
/// ends, satisfies all limits but `normal_cosine` to the edge's triangle. The edges have the order and the orientation
/// of their triangles. Cost: linear in the boundary.
std::vector<PatchEdge> find_patch_edges(const Surface& surface, PointChooser& chooser, const Limits& limits,
                                        const Context& context);

/// Sets the mesh's sharp edges: the creases of `lines`, the patch edges and `more`. Pre: `lines` belong to `finished`.
/// Cost: linear, and a sort of the sharp edges.
void set_sharp_edges(FinishedMesh& finished, const FeatureLines& lines, std::span<const PatchEdge> patch_edges,
                     std::span<const Edge> more);

/// Sets the right normal of every boundary segment that is a patch edge to the normal of the other patch. This is the
/// mean normal of the triangles at the point `beyond`. Pre: `features` belong to `finished`. Cost: linear, and a search
/// per segment.
void set_normals_beyond(FeatureGraph& features, const FinishedMesh& finished, std::span<const PatchEdge> patch_edges);

}  // namespace scanmill::growing
