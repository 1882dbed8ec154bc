// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Weights that a scan brings along, as a column.

#include <string>

#include "scanmill/data/points.hpp"

namespace scanmill {

/// Far enough from what a double can hold that squares of distances stay numbers beside it.
inline constexpr double largest_weight = 1e200;

/// The column's numbers times factor. Throws Error when there is no such column (naming those that there are), when it
/// has no single number per point, and when a weight is NaN, infinite, negative or above largest_weight: how many are,
/// and which is the first. Pre: factor is a number of 0 or more.
Array<double> column_weights(const PointCloud& cloud, const std::string& name, double factor);

}  // namespace scanmill
