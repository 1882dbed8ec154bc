// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// From a path with wildcards to the files that it means.

#include <filesystem>
#include <string>
#include <vector>

#include "scanmill/batch/batch.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill {

/// The regular files below `folder` (or anywhere, when `pattern` is absolute) that `pattern` leads to, sorted by the
/// bytes of their paths, which begin as folder and pattern do. `*`, `?` and `[…]` stand for parts of one name, a
/// component `**` for any number of folders, none included; no wildcard takes a leading dot. `**` does not follow links
/// to folders. A path that is there as it is written is that file, whatever characters it has. Throws Error, saying
/// where was looked: no file, a folder in place of a file, a folder that cannot be read, more than a million names
/// looked at.
std::vector<std::filesystem::path> scan_files(const std::filesystem::path& folder, const std::string& pattern);

// `scans`: the files that a batch is about, and what is known of each.

/// Paths count from `folder`. What is wrong is reported and left out.
std::vector<BatchScan> parse_scans(const YamlNode& node, const std::filesystem::path& folder, Diagnostics& diagnostics);

/// The values under `set:`; each one's position is that of its name. What is wrong is reported and left out.
Settings parse_settings(const YamlNode& node, Diagnostics& diagnostics);

}  // namespace scanmill
