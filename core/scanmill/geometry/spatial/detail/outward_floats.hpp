// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Doubles as the floats just below or above them: boxes in half the memory that still hold what they held.

#include <cmath>
#include <limits>

namespace scanmill {

/// Below `value`, also where that is a float itself.
inline float rounded_down(double value) {
    const float nearest = static_cast<float>(value);
    return std::nextafterf(nearest, -std::numeric_limits<float>::infinity());
}
/// Above `value`.
inline float rounded_up(double value) { return -rounded_down(-value); }

}  // namespace scanmill
