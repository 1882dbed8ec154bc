// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The parts of a batch that are plain numbers: `limits` and `measure`.

#include "scanmill/batch/batch.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill {

/// Most attempts after the first, so that what always fails does not take all night.
inline constexpr int most_retries = 10;
/// As many points are drawn at most to compare two surfaces.
inline constexpr std::int64_t most_samples = 1'000'000'000;

/// What is wrong is reported and left out.
Limits parse_limits(const YamlNode& node, Diagnostics& diagnostics);
MeasureOptions parse_measure(const YamlNode& node, Diagnostics& diagnostics);

}  // namespace scanmill
