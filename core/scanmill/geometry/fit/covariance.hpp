// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How points spread about their centroid: the plane that fits them best, and whether they fill it.

#include <span>

#include "scanmill/data/frame.hpp"

namespace scanmill {

struct Scatter {
    Vec3 centroid;
    /// Unit length, in the direction of least spread, by with_positive_sign(); some direction across a line, (0, 0, 1)
    /// for one place.
    Vec3 normal;
    /// Product of the two larger principal variances over the square of their sum: 1/4 for a round disc, 0 for a line;
    /// of a strip about its squared width over its squared length.
    double flatness;
    /// Variance along the normal over that in all directions, 0 to 1/3; 0 for one place.
    double roughness;
};

/// Pre: at least one point, coordinates at most some 1e50 in size and the largest not below 1e-50; relative to a point
/// near by, else digits are lost. Uses exactly rounded operations only, so that every processor finds the same bits.
Scatter scatter_of(std::span<const Vec3> points);

/// The one of v and -v whose coordinate of largest size (of equal ones the first) is positive.
Vec3 with_positive_sign(const Vec3& v);

}  // namespace scanmill
