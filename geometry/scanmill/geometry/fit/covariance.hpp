// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The spread of points about their centroid: the plane that fits them best, and whether they fill it.

#include <span>

#include "scanmill/data/frame.hpp"

namespace scanmill {

struct Scatter {
    Vec3 centroid;
    /// Unit length, in the direction of least variance, by with_positive_sign(); a direction perpendicular to a line of
    /// points; (0, 0, 1) for equal points.
    Vec3 normal;
    /// The product of the two larger principal variances over the square of their sum: 1/4 for a round disc, 0 for a
    /// line, about (width / length)² for a narrow strip.
    double flatness;
    /// The least principal variance over the sum of the three, 0 to 1/3; 0 for equal points.
    double surface_variation;
};

/// Pre: at least one point; coordinates relative to a nearby point, else digits are lost. Uses only exactly rounded
/// operations, so the bits do not depend on the processor.
Scatter scatter_of(std::span<const Vec3> points);

/// v or -v, whichever has a positive coordinate of largest magnitude (of equal magnitudes the first).
Vec3 with_positive_sign(const Vec3& v);

}  // namespace scanmill
