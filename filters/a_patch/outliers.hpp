// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Distances beyond which points are outliers.

#include <limits>

#include "scanmill/data/mesh.hpp"

namespace scanmill::a_patches {

/// By triangle: 3 times the median distance of the points over the triangle and its neighbours; 0 without points.
/// Infinite distances do not count. Cost: linear.
///
/// A median over all points would be 0 on an object with many exactly flat triangles. Where noise varies, it would be
/// too large or too small.
///
/// `neighbours` are given by triangle; invalid indices are ignored.
std::vector<double> outlier_distances(std::span<const double> distances, std::span<const u32> triangle_of_point,
                                      std::span<const std::array<u32, 3>> neighbours);

/// The distance of a point that does not count.
inline constexpr double no_distance = std::numeric_limits<double>::infinity();

}  // namespace scanmill::a_patches
