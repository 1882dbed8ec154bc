// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How large a triangle is: no place in it is farther from its nearest corner than the radius told here.

#include <algorithm>

namespace scanmill::growing {

/// The squared radius of the smallest circle that holds the triangle of these squared sides and area: the circle
/// through the corners, or the one over the longest side.
inline double squared_circle(double a, double b, double c, double twice_area) {
    const double longest = std::max({a, b, c});
    if (2 * longest >= a + b + c) return longest / 4;
    return a * b * c / (4 * twice_area * twice_area);
}

}  // namespace scanmill::growing
