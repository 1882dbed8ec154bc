// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Writes pages of a run to files.
///
/// Both functions make the missing previews with `jobs` worker processes, by default one per core, write the page, and
/// print its path on stdout and its notes as warnings on stderr. The file appears whole or not at all. They throw Error
/// if the program has no such page, for a folder without records, for a file that exists and is not a page, and if the
/// file cannot be written.

#include <filesystem>
#include <optional>
#include <string>

#include "scanmill/compare/recorded.hpp"

namespace scanmill::runner {

/// Writes the report page.
void write_page_file(const std::filesystem::path& file, const RecordedRun& which,
                     const std::optional<RecordedRun>& against, std::optional<unsigned> jobs);

/// Writes the sheets of the inspected parts that `parts` names, as sheet_document() does.
void write_sheet_file(const std::filesystem::path& file, const RecordedRun& which, const std::string& parts,
                      std::optional<unsigned> jobs);

}  // namespace scanmill::runner
