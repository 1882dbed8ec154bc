// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The content of files that readers cannot read directly: gzip data and text in UTF-16.

#include <cstdint>
#include <optional>
#include <string_view>

#include "scanmill/data/array.hpp"
#include "scanmill/kinds/kind.hpp"

namespace scanmill {

/// The wrapping of a file's content. The first bytes decide: those of gzip, or the byte order mark of UTF-16.
enum class Wrapping { none, gzip, utf16 };
Wrapping wrapping_of(std::string_view bytes);

/// The decompressed content of all members of the gzip file (RFC 1952). Throws Error for truncated or damaged data, and
/// for more than `most` bytes of content. Warns about bytes after the last member, unless all are zero (padding).
/// Memory: up to three times the content while the buffer grows.
Array<char> decompressed(std::string_view gzip, std::uint64_t most, const OnWarning& on_warning = {});

/// The text as UTF-8, without a byte order mark. Unpaired surrogates become '?'. Throws Error for an odd number of
/// bytes. Pre: wrapping_of() is utf16.
Array<char> utf8_of(std::string_view utf16);

/// The content in a form that readers can read: decompressed, then converted to UTF-8. nullopt if `bytes` have this
/// form already. Decompresses at most half of the available memory, because reading needs the rest.
std::optional<Array<char>> unwrapped(std::string_view bytes, const OnWarning& on_warning = {});

}  // namespace scanmill
