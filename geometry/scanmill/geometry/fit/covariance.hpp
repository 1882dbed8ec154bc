// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The spread of points about their centroid: the plane that fits them best, and whether they fill it.

#include <span>

#include "scanmill/data/frame.hpp"

namespace scanmill {

struct Scatter {
    Vec3 centroid;
    /// Unit vector in the direction of least variance, with the sign of with_positive_sign(). For points on a line it
    /// is perpendicular to the line; for equal points it is (0, 0, 1).
    Vec3 normal;
    /// The product of the two larger principal variances, divided by the square of their sum. It is 1/4 for a round
    /// disc, 0 for a line, and about (width / length)² for a narrow strip.
    double flatness;
    /// The least principal variance divided by the sum of the three, 0 to 1/3; 0 for equal points.
    double surface_variation;
};

/// Computes the scatter of the points. Uses only exactly rounded operations, so the bits do not depend on the
/// processor. Pre: at least one point; coordinates are relative to a nearby point, otherwise digits are lost.
Scatter scatter_of(std::span<const Vec3> points);

/// v or -v, whichever has a positive coordinate of largest magnitude. Of equal magnitudes, the first coordinate counts.
Vec3 with_positive_sign(const Vec3& v);

}  // namespace scanmill
