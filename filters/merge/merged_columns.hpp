// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The columns of several clouds, end to end: see merge() for what is carried, turned, made float64 and left out.

#include <memory>
#include <span>

#include "scanmill/data/points.hpp"
#include "scanmill/data/transform.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::merging {

/// In the order in which the names first appear, `source` last. Whatever does not arrive as it was is told through
/// context.warn(). Pre: `poses` is empty or as long as `clouds`, of which there is at least one.
ColumnTable merged_columns(std::span<const std::shared_ptr<const PointCloud>> clouds,
                           std::span<const RigidTransform> poses, Context& context);

}  // namespace scanmill::merging
