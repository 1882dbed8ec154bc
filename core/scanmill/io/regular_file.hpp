// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a path leads to instead of a file.

#include <filesystem>
#include <optional>

#include "scanmill/base/error.hpp"

namespace scanmill {

/// Says what is there, a folder, a pipe, a device or nothing, and what can be done; nothing for a file. Opens nothing,
/// for opening a pipe would wait for who writes into it. Whether a file may be read is not asked.
std::optional<Error> why_no_file(const std::filesystem::path& path);

}  // namespace scanmill
