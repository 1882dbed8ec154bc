// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Columns that thinning makes, beside those that the scan brought.

#include <span>
#include <vector>

#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::voxel {

/// Appends the columns; older ones of their names give way, and that is told. Pre: a row per point, names unique.
void add_columns(PointCloud& thinned, std::vector<Column> added, Context& context);

/// Adds `bin-size` (float64): per kept point the edge of the bin that it was kept from. `edges` has one for every
/// point, or is empty where all are the grid's. Points that were thinned before lie as the larger of both bins leave
/// them: where the scan brought such a column, one finite number above 0 for each, its larger ones stay, and that is
/// told.
void add_bin_sizes(PointCloud& thinned, std::span<const double> edges, double grid_edge, Context& context);

}  // namespace scanmill::voxel
