// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Directions that users write as three numbers.

#include <span>
#include <string_view>

#include "scanmill/data/frame.hpp"

namespace scanmill {

/// The unit vector of the x, y, z that a parameter contains; `name` is the parameter as messages call it. Throws Error
/// for other than three numbers, for numbers that are not finite, and for three zeros.
Vec3 direction_of(std::span<const double> numbers, std::string_view name);

}  // namespace scanmill
