// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The normals beyond sharp edges where two patches end side by side: a feature line of one tells the other's as well.

#include "region_grow/finished_mesh.hpp"
#include "region_grow/patch_edges.hpp"
#include "scanmill/data/features.hpp"

namespace scanmill::growing {

/// Sets the right normal of every boundary segment that is a patch edge: that of the other patch, the mean over its
/// triangles at the place beyond. Pre: `features` of `finished`. Cost: linear, and a search per segment.
void tell_far_sides(FeatureGraph& features, const FinishedMesh& finished, const Samples& samples,
                    std::span<const PatchEdge> patch_edges);

}  // namespace scanmill::growing
