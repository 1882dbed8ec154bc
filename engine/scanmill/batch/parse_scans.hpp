// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `scans`: the files that a batch is about, and what is known of each.

#include "scanmill/batch/batch.hpp"
#include "scanmill/engine/document.hpp"

namespace scanmill {

/// Paths count from `folder`. What is wrong is reported and left out.
std::vector<BatchScan> parse_scans(const YamlNode& node, const std::filesystem::path& folder, Diagnostics& diagnostics);

}  // namespace scanmill
