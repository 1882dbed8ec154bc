// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Areas and volumes as people write them: a number and a power of a unit of length, as `12 mm2` or `0.5 u3`.
///
/// Every unit of a Length may be raised: 3 cm2 are three squares of 1 cm, 5 %diag3 five cubes whose edge is 1 % of the
/// diagonal. `²`, `³`, `^2` and `^3` are read as well, because results are printed so.

#include <optional>
#include <string_view>

#include "scanmill/data/metrics.hpp"
#include "scanmill/data/quantity.hpp"

namespace scanmill {

/// 1 for lengths, 2 for areas, 3 for volumes, 0 for what has no length in it.
int power_of_length(Unit unit);

/// The number that was written, in the unit that is to be raised to `power`. Throws Error with what was expected. Pre:
/// power is 2 or 3.
Length parse_length_power(std::string_view text, int power);

/// Whether it is in a unit of the world, and so means the same on every scan.
bool is_absolute(const Length& length);

/// Such a number in the scan's unit, raised. Throws Error as Length::resolved() does.
double resolved_length_power(const Length& written, int power, const LengthScale& scale);

/// "12 mm3, 0.5 u3 or 20 spacing3": how an area or a volume is written, for messages.
std::string_view length_power_examples(int power);

}  // namespace scanmill
