// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Weights that follow the sampling: large where the points are far apart.

#include <span>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

/// How many nearest neighbours say how dense the sampling is at a point.
inline constexpr std::size_t spacing_neighbours = 6;
/// The largest factor: beyond it a point would be compared with too many others.
inline constexpr double largest_spacing_factor = 4;

/// Per point factor · s², where s is the mean distance to the six nearest other places (all, if there are fewer);
/// lowered to what no other place forbids: w_i ≤ w_j + 0.9 d² for all places j at distance d, which is the largest
/// solution of these inequalities. A point then has a smaller power distance to itself than to any other, so none is
/// hidden (unless two are so close that rounding decides).
///
/// Pre: finite positions at two places or more; factor in [0, largest_spacing_factor].
/// Points at one place have the same weight. It depends neither on the order of the points nor on the number of
/// threads. Cost: O(n log n), and for the inequalities about 60 bytes per point and a few passes. Progress up to 0.25.
Array<double> spacing_weights(std::span<const Vec3> positions, double factor, Context& context);

}  // namespace scanmill
