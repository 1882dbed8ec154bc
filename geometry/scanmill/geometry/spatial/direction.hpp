// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Directions and positions that users write as three numbers or lengths.

#include <span>
#include <string_view>

#include "scanmill/data/quantity.hpp"

namespace scanmill {

/// The unit vector of the x, y, z that a parameter contains; `name` is the parameter as messages call it. Throws Error
/// for other than three numbers, for numbers that are not finite, and for three zeros.
Vec3 direction_of(std::span<const double> numbers, std::string_view name);

/// The same for the position with these x, y, z. Throws Error for other than three lengths, and for lengths that are
/// not finite.
Vec3 position_of(std::span<const Length> lengths, std::string_view name);

}  // namespace scanmill
