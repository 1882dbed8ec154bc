// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Splits text into characters. The text may contain names of files, which may have any bytes.

#include <string_view>

namespace scanmill {

/// The number of bytes of the UTF-8 character at the beginning of the text; 0 if the bytes are not a valid character,
/// or if XML does not allow it.
std::size_t character_length(std::string_view text);

inline bool is_control(char c) { return static_cast<unsigned char>(c) < ' ' || c == 0x7f; }

}  // namespace scanmill
