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

/// "500 MiB", "20GiB", "1.5 GB", "4096": bytes. Throws Error with the expected form.
u64 parse_byte_size(std::string_view text);

/// "10 min", "1.5h", "250 ms": seconds, finite and not negative. Throws Error with the expected form; a number without
/// a unit is refused.
double parse_duration(std::string_view text);

/// "250 ms", "90 s", "10 min", "1.5 h": shortest digits, in the largest unit that gives at least 1.
std::string duration_text(double seconds);

// Areas and volumes: a number and a power of a unit of length, as `12 mm2` or `0.5 u3`. Every unit of a Length may be
// raised: 3 cm2 are three squares of 1 cm, 5 %diag3 five cubes whose edge is 1 % of the diagonal. `²`, `³`, `^2` and
// `^3` are read as well, because results are printed so.

/// 1 for lengths, 2 for areas, 3 for volumes, 0 for all other units.
int power_of_length(Unit unit);

/// The amount as written, in the unit that is to be raised to `power`. Throws Error with the expected form. Pre: power
/// is 2 or 3.
Length parse_length_power(std::string_view text, int power);

/// Whether the length is in a unit that is the same on every scan.
bool is_absolute(const Length& length);

/// The amount in the scan's unit raised to `power`. Throws Error as Length::resolved() does.
double resolved_length_power(const Length& written, int power, const LengthScale& scale);

/// "12 mm3, 0.5 u3 or 20 spacing3", for messages.
std::string_view length_power_examples(int power);

}  // namespace scanmill
