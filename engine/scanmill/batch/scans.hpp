// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Parses `scans` of a batch: finds the files that match paths with wildcards, and reads their units, frames, poses,
/// truths and values.

#include <filesystem>
#include <string>
#include <vector>

#include "scanmill/batch/batch.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill {

/// Finds the regular files that match `pattern`. A relative pattern counts from `folder`. The paths begin as folder and
/// pattern do and are sorted by their bytes.
///
/// `*`, `?` and `[…]` match parts of one name. A component `**` matches any number of folders, including none, and does
/// not follow links to folders. No wildcard matches a leading dot. If a file has exactly the path `pattern`, the result
/// is that file, even if the path contains wildcard characters.
///
/// `warn` gets a sentence for every folder that cannot be read, except the first, and for every matching link without a
/// target. Their files are left out. Throws Error if no file matches, if the path is a folder, if the first folder
/// cannot be read, and after more than a million names.
std::vector<std::filesystem::path> scan_files(const std::filesystem::path& folder, const std::string& pattern,
                                              const OnWarning& warn = {});

/// The path as it is written in a batch file in `folder`: relative to the folder, unless only one of them is absolute.
std::filesystem::path path_from(const std::filesystem::path& folder, const std::filesystem::path& path);

/// Parses the list of scans. Paths count from `folder`. Reports wrong entries and leaves them out.
std::vector<BatchScan> parse_scans(const YamlNode& node, const std::filesystem::path& folder, Diagnostics& diagnostics);

/// Parses the values under `set:`. The position of a value is the position of its name. Reports wrong values and leaves
/// them out.
Settings parse_settings(const YamlNode& node, Diagnostics& diagnostics);

}  // namespace scanmill
