// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Which points stay where clouds overlap: see merge() for the rule.

#include <span>

#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::merging {

/// Rows that are kept, ascending; all of them when `within` is 0. `source` says which cloud a row is of; rows of one
/// cloud lie side by side, clouds ascend. `preference` is empty or has a number per row, the smaller the better.
/// Throws Error for points that are so far apart that their distance is not finite.
Array<u32> without_overlap(std::span<const Vec3> positions, std::span<const u32> source,
                           std::span<const double> preference, double within, Context& context);

}  // namespace scanmill::merging
