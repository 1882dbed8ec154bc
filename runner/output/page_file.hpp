// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Writes the report page of a run to a file.

#include <filesystem>
#include <optional>

#include "scanmill/compare/recorded.hpp"

namespace scanmill::runner {

/// Makes the missing previews, writes the page, and prints its path on stdout and its notes as warnings on stderr. The
/// file appears whole or not at all. Throws Error if the program has no page, for a folder without records, and if the
/// file cannot be written.
void write_page_file(const std::filesystem::path& file, const RecordedRun& which,
                     const std::optional<RecordedRun>& against);

}  // namespace scanmill::runner
