// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Small files that are whole or refused: a line with the kind of thing, the file's name and the hash of the rest, then
/// the rest.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace scanmill {

/// Appears whole or not at all, without being synced to the disk. Throws Error.
void write_checked(const std::filesystem::path& file, std::string_view kind, std::string_view content);

/// Nothing when there is no such file. Throws Error when it is of another kind, was written under another name, or
/// its bytes are not those that were written.
std::optional<std::string> read_checked(const std::filesystem::path& file, std::string_view kind);

}  // namespace scanmill
