// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The comparison of a run with the accepted run, as text for people.

#include <filesystem>
#include <optional>
#include <string>

#include "scanmill/compare/comparison.hpp"

namespace scanmill::runner {

/// Returns about a screen of text. It has the verdict, the counts, the runs, the version, the machine, what changed,
/// and what failed and why. The matrix of one metric follows, then the commands that reproduce the failed and regressed
/// cells. Long lists are cut. `width`: columns of the terminal; empty: no limit.
std::string comparison_text(const Comparison& comparison, const std::string& metric, std::optional<std::size_t> width);

/// The verdict, the counts and the first cells that did not pass. It is printed at the end of a batch into this folder.
std::string verdict_text(const Comparison& comparison, const std::filesystem::path& folder);

}  // namespace scanmill::runner
