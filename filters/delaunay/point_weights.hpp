// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The weights that the parameters of delaunay() ask for, ready for a regular triangulation: from a column, or from the
/// local spacing of the points.

#include <span>
#include <string>

#include "delaunay/delaunay.hpp"

namespace scanmill {

struct PointWeights {
    /// Per input row; equal at points of one position.
    Array<double> weights;
    /// Rows at the position of an earlier row, ascending.
    Array<u32> duplicates;
};

/// If points at one position have different weights, the largest counts; a warning gives the number of such
/// positions. With `spacing`, a warning says that a column of that name is not read. Pre: params.weights, finite
/// positions, at least two distinct. Throws Error for a factor that is negative or not finite, or too large for
/// `spacing`, and for what column_weights() refuses.
PointWeights point_weights(const PointCloud& cloud, const DelaunayParams& params, Context& context);

/// The square of the largest length in a scan of supported size. Larger numbers in a column are not squared lengths of
/// the scan; often they mark missing values.
inline constexpr double largest_weight = 1e18;

/// The column's numbers times factor. Throws Error when there is no such column (listing the existing ones), when it
/// does not have a single number per point, and when a weight is NaN, infinite, negative or above largest_weight, with
/// their number and the first one. Pre: factor is finite and 0 or more.
Array<double> column_weights(const PointCloud& cloud, const std::string& name, double factor);

/// The number of nearest neighbours whose mean distance is the local spacing.
inline constexpr std::size_t spacing_neighbours = 6;
/// The largest factor: beyond it a point would be compared with too many others.
inline constexpr double largest_spacing_factor = 4;

/// Per point factor · s², where s is the mean distance to the nearest spacing_neighbours other positions (all, if there
/// are fewer), lowered so that w_i ≤ w_j + 0.9 d² for all other positions j at distance d: the largest solution of
/// these inequalities. A point then has a smaller power distance to itself than to any other, so none is hidden (unless
/// two are so close that rounding decides).
///
/// Pre: finite positions, at least two distinct; factor in [0, largest_spacing_factor].
/// Points at one position have the same weight. The result depends neither on the order of the points nor on the number
/// of threads. Cost: O(n log n), and for the inequalities about 60 bytes per point and a few passes. Progress up to
/// 0.25.
Array<double> spacing_weights(std::span<const Vec3> positions, double factor, Context& context);

/// The columns and `hidden`, 1 for the vertices `rows` and 0 for the others. An input column `hidden` is renamed
/// `hidden-of-points`, with a warning.
ColumnTable with_hidden(const ColumnTable& columns, std::size_t vertices, std::span<const u32> rows, Context& context);

}  // namespace scanmill
