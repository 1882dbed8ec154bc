// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Where the points of several clouds lie once each cloud was moved by its pose.

#include <memory>
#include <span>

#include "scanmill/data/points.hpp"
#include "scanmill/data/transform.hpp"

namespace scanmill::merging {

/// All positions end to end, with the frame of the result and no columns. A pose maps world coordinates: origin o plus
/// position p goes to R (o + p) + t, computed as R p + (R o + t - origin of the result), so that what is large cancels
/// before a position is added. Without poses positions are only brought to the first cloud's origin.
/// Pre: `poses` is empty or as long as `clouds`, which are finite and of one unit. Throws Error for a pose in a known
/// unit when that of the clouds is not, and when a moved coordinate is not finite.
PointCloud placed_points(std::span<const std::shared_ptr<const PointCloud>> clouds,
                         std::span<const RigidTransform> poses);

}  // namespace scanmill::merging
