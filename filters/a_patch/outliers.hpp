// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The distance beyond which a point is an outlier.

#include <limits>

#include "scanmill/data/mesh.hpp"

namespace scanmill::a_patches {

/// By triangle: 3 times the median of the distances of the points over the triangle and its neighbours; 0 without
/// points. Not that of all points, which is 0 on an object with many exactly flat triangles, and too large or too small
/// where noise varies. Infinite distances do not count. Cost: linear.
///
/// `neighbours`: by triangle; indices of no triangle are ignored.
std::vector<double> outlier_distances(std::span<const double> distances, std::span<const u32> triangle_of_point,
                                      std::span<const std::array<u32, 3>> neighbours);

/// The distance of a point that does not count.
inline constexpr double no_distance = std::numeric_limits<double>::infinity();

}  // namespace scanmill::a_patches
