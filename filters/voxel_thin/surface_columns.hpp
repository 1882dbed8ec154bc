// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What thinning by a tolerance has learned about the scan, as columns of the kept points.

#include <span>

#include "voxel_thin/local_bins.hpp"

namespace scanmill::voxel {

/// Adds `curvature-1`, `curvature-2`, `fit-error`, `local-bin-size` (float64) and `stands-for` (uint32) to the thinned
/// cloud; columns of these names that the scan had are replaced, and that is told. `kept` names the points' rows in the
/// input, `members` how many points share the bin of each.
void add_surface_columns(PointCloud& thinned, const LocalBins& bins, std::span<const u32> kept,
                         std::span<const u32> members, Context& context);

}  // namespace scanmill::voxel
