// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether two clouds are equal to the last bit.

#include <cstring>

#include "scanmill/data/points.hpp"

namespace scanmill::test {

inline bool same_points(const PointCloud& a, const PointCloud& b) {
    return a.frame == b.frame && a.size() == b.size() && a.columns == b.columns &&
           std::memcmp(a.positions.data(), b.positions.data(), a.size() * sizeof(Vec3)) == 0;
}

}  // namespace scanmill::test
