// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Sizes of memory and files, as people write them.

#include <string>
#include <string_view>

#include "scanmill/data/array.hpp"

namespace scanmill {

/// "500 MiB", "20GiB", "1.5 GB", "4096": bytes. Throws Error with what was expected.
u64 parse_byte_size(std::string_view text);

/// "1.50 GiB", "20.0 GiB", "512 MiB".
std::string byte_size_text(u64 bytes);

// Spans of time, as people write them.

/// "10 min", "1.5h", "250 ms": seconds, finite and not negative. Throws Error with what was expected; a number without
/// its unit is refused too.
double parse_duration(std::string_view text);

/// "250 ms", "90 s", "10 min", "1.5 h": shortest digits, in the largest unit of which there is at least one.
std::string duration_text(double seconds);

}  // namespace scanmill
