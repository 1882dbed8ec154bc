// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Directions and positions that users write as three numbers or lengths.

#include <span>
#include <string_view>

#include "scanmill/data/quantity.hpp"

namespace scanmill {

/// The unit vector with the x, y, z of a parameter. `name` is the parameter's name for messages. Throws Error unless
/// there are three finite numbers that are not all zero.
Vec3 direction_of(std::span<const double> numbers, std::string_view name);

/// The position with the x, y, z of a parameter. `name` is the parameter's name for messages. Throws Error unless there
/// are three finite lengths.
Vec3 position_of(std::span<const Length> lengths, std::string_view name);

}  // namespace scanmill
