// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The comparison of a run with the accepted run, as text for people.

#include <filesystem>
#include <optional>
#include <string>

#include "scanmill/compare/comparison.hpp"

namespace scanmill::runner {

/// Returns about a screen of text: the verdict, the counts, the runs, version and machine; per rule and variant the
/// number of cells and the median change; the worst changes; what failed and why; the commands that reproduce failed
/// and regressed cells; and what prints the rest. Long lists are cut. With `metric`, a table of this metric with a row
/// per scan replaces what follows the machine. `width`: columns of the terminal; empty: no limit.
std::string comparison_text(const Comparison& comparison, const std::filesystem::path& folder,
                            const std::string& metric, std::optional<std::size_t> width);

/// The verdict, the counts and the first cells that did not pass. It is printed at the end of a batch into this folder.
std::string verdict_text(const Comparison& comparison, const std::filesystem::path& folder);

}  // namespace scanmill::runner
