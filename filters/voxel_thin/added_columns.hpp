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

/// `bin-size` (float64): per kept point the edge of the bin that it was kept from. `edges` has one for every point, or
/// is empty where all are the grid's.
Column bin_sizes(std::size_t points, std::span<const double> edges, double grid_edge);

}  // namespace scanmill::voxel
