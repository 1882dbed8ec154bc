// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The weights that the parameters of delaunay() ask for, ready for a regular triangulation.

#include "delaunay/delaunay.hpp"

namespace scanmill {

struct PointWeights {
    /// Per input row; equal at points of one place.
    Array<double> weights;
    /// Rows at the place of an earlier row, ascending.
    Array<u32> duplicates;
};

/// Of several points at one place with different weights the largest counts; a warning says at how many places.
/// With `spacing`, a column of that name is told to be left alone. Pre: params.weights, finite positions at two places
/// or more. Throws Error for a scan that is not between 1e-100 and 1e100 in size, a factor that is no number of 0 or
/// more, or too large for `spacing`, and what column_weights() refuses.
PointWeights point_weights(const PointCloud& cloud, const DelaunayParams& params, Context& context);

/// The columns and `hidden`, 1 for the vertices `rows` and 0 for the others. A column that is called so already becomes
/// `hidden-of-points`, told by a warning.
ColumnTable with_hidden(const ColumnTable& columns, std::size_t vertices, std::span<const u32> rows, Context& context);

}  // namespace scanmill
