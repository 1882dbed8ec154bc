// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The columns that voxel-thin adds to the kept points.

#include <span>

#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"
#include "voxel_thin/local_sizes.hpp"

namespace scanmill::voxel {

/// Adds `bin-size` (float64): per kept point the edge of its voxel. `edges` has one per point, or is empty where all
/// are `grid_edge`. Where the scan has such a column of one finite number above 0 per point, its larger values stay,
/// with a warning: points that were thinned before keep the spacing of the larger voxels.
void add_bin_sizes(PointCloud& thinned, std::span<const double> edges, double grid_edge, Context& context);

/// Adds `curvature-1`, `curvature-2`, `fit-error`, `local-bin-size` (float64) and `stands-for` (uint32). Columns of
/// these names that the scan had are replaced, with a warning. `kept` are the points' rows in the input, `members` the
/// number of points in the voxel of each.
void add_surface_columns(PointCloud& thinned, const LocalSizes& local, std::span<const u32> kept,
                         std::span<const u32> members, Context& context);

}  // namespace scanmill::voxel
