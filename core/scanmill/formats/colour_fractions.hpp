// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Bytes of colour written as decimals from 0 to 1, a full channel being 1.
///
/// A decimal stands for the byte b when it is b / 255, rounded to its own digits behind the point, at least three of
/// them, or computed in single precision: 0.502, 0.50196 and 0.501960813999 are 128; 0.5 is no byte's.

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "scanmill/data/array.hpp"

namespace scanmill {

/// Pre: `value` is the number that `spelling` reads as.
std::optional<u8> byte_of_fraction(std::string_view spelling, double value);

/// For every byte its shortest decimal. Programs that cut the product with 255, in single precision or double, to a
/// whole number instead of rounding it find the same byte.
std::array<std::string, 256> colour_fractions();

}  // namespace scanmill
