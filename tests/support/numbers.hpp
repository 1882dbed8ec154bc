// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Numbers that many tests use.

#include <limits>
#include <numbers>

namespace scanmill::test {

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double degree = std::numbers::pi / 180;  ///< in radians

}  // namespace scanmill::test
