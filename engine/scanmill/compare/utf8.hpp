// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Characters of text whose bytes come from names of files and may be anything.

#include <string_view>

namespace scanmill {

/// The bytes of the UTF-8 character with which the text begins; 0 if it is not valid, or not allowed in XML.
std::size_t character_length(std::string_view text);

inline bool is_control(char c) { return static_cast<unsigned char>(c) < ' ' || c == 0x7f; }

}  // namespace scanmill
