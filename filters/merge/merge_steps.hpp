// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The two larger steps of merge(), which states the rules: the columns of the result, and the choice of the points
/// that are kept where clouds overlap.

#include <memory>
#include <span>

#include "scanmill/data/points.hpp"
#include "scanmill/data/transform.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::merging {

/// The cloud with a column `uncertainty` of lengths: `value` where it has NaN, and everywhere, as `type` (float32 or
/// float64), where the cloud has no such column. A column of lists or of several components stays as it is.
PointCloud with_default_uncertainty(const PointCloud& cloud, ScalarType type, double value);

/// The columns of the clouds, end to end, in the order in which their names first appear, `source` last. Warns about
/// every column that is left out or changed. Pre: `poses` is empty or as long as `clouds`, of which there is at least
/// one.
ColumnTable merged_columns(std::span<const std::shared_ptr<const PointCloud>> clouds,
                           std::span<const RigidTransform> poses, Context& context);

/// Rows that are kept, ascending; all of them when `within` is 0. `source` is the number of the cloud of each row; rows
/// of one cloud are contiguous, clouds ascend. `preference` is empty or has a number per row, the smaller the better.
Array<u32> without_overlap(std::span<const Vec3> positions, std::span<const u32> source,
                           std::span<const double> preference, double within, Context& context);

}  // namespace scanmill::merging
