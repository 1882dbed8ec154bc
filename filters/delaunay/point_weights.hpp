// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Weights of points for a regular triangulation, as the parameters of delaunay() request: from a column, or from the
/// local spacing of the points.

#include <span>
#include <string>

#include "delaunay/delaunay.hpp"

namespace scanmill {

struct PointWeights {
    /// By input row. Points at one position have equal weights.
    Array<double> weights;
    /// Rows at the position of an earlier row, ascending.
    Array<u32> duplicates;
};

/// Computes the weights. If points at one position have different weights, the largest counts; a warning gives the
/// number of such positions. With `spacing`, an existing column of that name is not read, with a warning. Pre:
/// params.weights is set; finite positions, at least two distinct. Throws Error for a factor that is negative or not
/// finite, or too large for `spacing`, and as column_weights() does.
PointWeights point_weights(const PointCloud& cloud, const DelaunayParams& params, Context& context);

/// The square of the largest length in a scan of supported size. Larger numbers in a column are not squared lengths of
/// the scan; often they mark missing values.
inline constexpr double largest_weight = 1e18;

/// The column's numbers times `factor`. Throws Error if there is no such column; the message lists the existing ones.
/// Also throws if the column does not have a single number per point, or if weights are NaN, infinite, negative or
/// above largest_weight; the message gives their number and the first one. Pre: `factor` is finite and 0 or more.
Array<double> column_weights(const PointCloud& cloud, const std::string& name, double factor);

/// The number of nearest neighbours whose mean distance is the local spacing.
inline constexpr std::size_t spacing_neighbours = 6;
/// The largest factor. With a larger one, a point would be compared with too many others.
inline constexpr double largest_spacing_factor = 4;

/// By input row: factor · s², where s is the mean distance to the nearest spacing_neighbours other positions (all
/// others, if there are fewer). The weights are then lowered to the largest ones with w_i ≤ w_j + 0.9 d² for every two
/// positions i and j at distance d. So the power distance of a point to itself is smaller than to any other point, and
/// no point is hidden. Rounding may hide one of two points that are extremely close.
///
/// Pre: finite positions, at least two distinct; factor in [0, largest_spacing_factor].
/// Points at one position have the same weight. The result depends neither on the order of the points nor on the number
/// of threads. Cost: O(n log n); the inequalities take about 60 bytes per point and a few passes. Reports progress up
/// to 0.25.
Array<double> spacing_weights(std::span<const Vec3> positions, double factor, Context& context);

/// Adds a column `hidden`: 1 for the vertices in `rows`, 0 for all others. An input column `hidden` is renamed
/// `hidden-of-points`, with a warning.
ColumnTable with_hidden(const ColumnTable& columns, std::size_t vertices, std::span<const u32> rows, Context& context);

}  // namespace scanmill
