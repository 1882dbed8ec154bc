// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Border edges that are no end of the points but a sharp edge: beyond them the surface goes on in another patch.

#include "region_grow/suitable_point.hpp"
#include "scanmill/data/features.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::growing {

struct PatchEdge {
    u32 from, to;
    /// The place of the other patch that the edge would have taken first.
    u32 beyond;
};

/// Border edges for which a place on the front, no neighbour of theirs, keeps to all limits but the one of the angle to
/// the triangle there: where nothing else ended the patch. In the order of the triangles, facing as they were grown.
/// Cost: linear in the border.
std::vector<PatchEdge> find_patch_edges(const Surface& surface, PointChooser& chooser, const Limits& limits,
                                        const Context& context);

// From places to the mesh that leaves the filter.

struct FinishedMesh {
    TriangleMesh mesh;
    /// Per vertex its row in the cloud.
    Array<u32> rows;
};

/// The used points in input order with all their columns, triangles as they were formed, lowest vertex first; sharp
/// edges: those that bend by more than `sharp_angle`, and the patches' edges. Cost: linear.
FinishedMesh finish_mesh(const PointCloud& cloud, const Surface& surface, std::span<const PatchEdge> patch_edges,
                         Angle sharp_angle);

// The normals beyond sharp edges where two patches end side by side: a feature line of one tells the other's as well.

/// Sets the right normal of every boundary segment that is a patch edge: that of the other patch, the mean over its
/// triangles at the place beyond. Pre: `features` of `finished`. Cost: linear, and a search per segment.
void tell_far_sides(FeatureGraph& features, const FinishedMesh& finished, const Samples& samples,
                    std::span<const PatchEdge> patch_edges);

}  // namespace scanmill::growing
