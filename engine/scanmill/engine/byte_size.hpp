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

}  // namespace scanmill
