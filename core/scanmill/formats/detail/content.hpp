// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The content of files that are not stored as readers expect it: gzip data and text in UTF-16.

#include <cstdint>
#include <optional>
#include <string_view>

#include "scanmill/data/array.hpp"
#include "scanmill/kinds/kind.hpp"

namespace scanmill {

/// By the first bytes: those of gzip, or the byte order mark of UTF-16.
enum class Wrapping { none, gzip, utf16 };
Wrapping wrapping_of(std::string_view bytes);

/// The decompressed content, of all members of the gzip file (RFC 1952). Throws Error: truncated or damaged data, or
/// more than `most` bytes of content. Warns of bytes after the last member, unless all are zero: padding. Cost: up to
/// three times the content while its memory grows.
Array<char> decompressed(std::string_view gzip, std::uint64_t most, const OnWarning& on_warning = {});

/// The text as UTF-8, without a byte order mark. Unpaired surrogates become '?'. Throws Error for an odd number of
/// bytes. Pre: wrapping_of() is utf16.
Array<char> utf8_of(std::string_view utf16);

/// Content that readers can read: decompressed, then as UTF-8; empty if `bytes` are such already. Decompresses at most
/// half of the available memory: reading needs the rest.
std::optional<Array<char>> unwrapped(std::string_view bytes, const OnWarning& on_warning = {});

}  // namespace scanmill
