// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The two larger steps of merge(): the columns of the result, and the choice of the points that are kept where clouds
/// overlap. The rules are in merge.hpp.

#include <memory>
#include <span>

#include "scanmill/data/points.hpp"
#include "scanmill/data/transform.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::merging {

/// The cloud with a column `uncertainty` of lengths. NaN in an existing column becomes `value`. A missing column is
/// added, with `value` in all rows and of type `type` (float32 or float64). A column of lists or of several components
/// stays as it is.
PointCloud with_default_uncertainty(const PointCloud& cloud, ScalarType type, double value);

/// The columns of the clouds, end to end, in the order in which their names first appear, `source` last. Warns about
/// every column that is left out or changed. Pre: at least one cloud; `poses` is empty or as long as `clouds`.
ColumnTable merged_columns(std::span<const std::shared_ptr<const PointCloud>> clouds,
                           std::span<const RigidTransform> poses, Context& context);

/// Rows that are kept, ascending; all rows if `within` is 0. `source`: the number of each row's cloud; rows are ordered
/// by cloud. `preference`: empty, or a number for each row; smaller is better.
Array<u32> without_overlap(std::span<const Vec3> positions, std::span<const u32> source,
                           std::span<const double> preference, double within, Context& context);

}  // namespace scanmill::merging
