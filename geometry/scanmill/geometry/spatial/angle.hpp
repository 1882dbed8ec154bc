// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Angles whose bits do not depend on the processor.
///
/// The C library chooses variants of atan2, sin and similar functions by the processor, and their last bits differ.
/// Decisions by angles, or by sums of angles, use these functions instead. They consist of +, -, *, /, sqrt and
/// comparisons, which IEEE 754 rounds in exactly one way. (All of Scanmill is compiled with -ffp-contract=off.)

#include <array>

#include "scanmill/data/frame.hpp"

namespace scanmill {

/// The angle of the direction (cosine, sine), in radians, in [0, π]; 0 if both are 0. The direction need not have unit
/// length.
///
/// Pre:   sine ≥ 0.
/// Error: at most 0.52 units in the last place; about one result in 10,000 is not the nearest double. Multiples of 45°
/// are the nearest doubles.
double angle_of(double cosine, double sine);

/// The angle between two vectors, in radians, in [0, π]; 0 if one of them is zero. Angles near 0 and π keep their
/// digits.
double angle_between(const Vec3& a, const Vec3& b);
/// The angle between a and b, and the angle between c and d. Both have the bits of angle_between(). The call takes
/// little longer than one call of angle_between().
std::array<double, 2> angles_between(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace scanmill
