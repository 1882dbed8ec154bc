// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Amounts with units that only workflows use: sizes of memory and files, spans of time, areas and volumes.

#include <string>
#include <string_view>

#include "scanmill/base/text.hpp"
#include "scanmill/data/array.hpp"
#include "scanmill/data/metrics.hpp"
#include "scanmill/data/quantity.hpp"

namespace scanmill {

/// The number of bytes that "500 MiB", "20GiB", "1.5 GB" or "4096" means. Throws Error with the expected form.
u64 parse_byte_size(std::string_view text);

/// The number of seconds that "10 min", "1.5h" or "250 ms" means; finite and not negative. Throws Error with the
/// expected form, also for a number without a unit.
double parse_duration(std::string_view text);

/// "250 ms", "90 s", "10 min", "1.5 h": the shortest digits, in the largest unit that gives at least 1. Below 1 s, the
/// unit is ms.
std::string duration_text(double seconds);

// Areas and volumes: a number and a power of a unit of length, as `12 mm2` or `0.5 u3`. The unit may be any unit of a
// Length: 3 cm2 are three squares with edges of 1 cm. 5 %diag3 are five cubes with edges of 1 % of the diagonal. The
// exponents `²`, `³`, `^2` and `^3` are read too, because printed results contain them.

/// The exponent of length in the unit: 1 for lengths, 2 for areas, 3 for volumes, 0 for all other units.
int power_of_length(Unit unit);

/// Parses an area (power 2) or a volume (power 3). The result holds the amount as written, and the unit before it is
/// raised to `power`. Throws Error with the expected form.
Length parse_length_power(std::string_view text, int power);

/// Whether the length is in a unit that is the same on every scan.
bool is_absolute(const Length& length);

/// The amount in the scan's unit raised to `power`. Throws Error as Length::resolved() does.
double resolved_length_power(const Length& written, int power, const LengthScale& scale);

/// Examples for messages: "12 mm3, 0.5 u3 or 20 spacing3".
std::string_view length_power_examples(int power);

}  // namespace scanmill
