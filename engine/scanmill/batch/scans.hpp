// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `scans` of a batch: the files that paths with wildcards match, with their units, frames, poses, truths and values.

#include <filesystem>
#include <string>
#include <vector>

#include "scanmill/batch/batch.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill {

/// The regular files below `folder` (or anywhere, if `pattern` is absolute) that match `pattern`, sorted by the bytes
/// of their paths, which begin as folder and pattern do. `*`, `?` and `[…]` match parts of one name, a component `**`
/// any number of folders, or none; no wildcard matches a leading dot. `**` does not follow links to folders. An
/// existing path that equals the pattern is that file, whatever characters it has. `warn` gets a sentence for every
/// folder below the first that cannot be read, and for every matching link that leads nowhere; their files are left
/// out. Throws Error naming the folder that was searched: no file, a folder in place of a file, an unreadable first
/// folder, more than a million names visited.
std::vector<std::filesystem::path> scan_files(const std::filesystem::path& folder, const std::string& pattern,
                                              const OnWarning& warn = {});

/// Paths count from `folder`. Wrong entries are reported and left out.
std::vector<BatchScan> parse_scans(const YamlNode& node, const std::filesystem::path& folder, Diagnostics& diagnostics);

/// The values under `set:`; each one's position is that of its name. Wrong values are reported and left out.
Settings parse_settings(const YamlNode& node, Diagnostics& diagnostics);

}  // namespace scanmill
