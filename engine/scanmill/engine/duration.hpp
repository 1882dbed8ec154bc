// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Spans of time, as people write them.

#include <string>
#include <string_view>

namespace scanmill {

/// "10 min", "1.5h", "250 ms": seconds, finite and not negative. Throws Error with what was expected; a number without
/// its unit is refused too.
double parse_duration(std::string_view text);

/// "250 ms", "90 s", "10 min", "1.5 h": shortest digits, in the largest unit of which there is at least one.
std::string duration_text(double seconds);

}  // namespace scanmill
