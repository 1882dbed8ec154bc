// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Explains why a step runs again: what changed since the last run of the same workflow into this folder.

#include "scanmill/cache/prediction.hpp"
#include "scanmill/records/run_records.hpp"

namespace scanmill {

/// Replaces the reason of steps that are not in the cache by the differences to the step of the same name on the same
/// scan in the newest run that has one: parameters with both values, the filter's version or build, the seed, the
/// scan's content, the results of earlier steps. If variants have several such steps, the most similar one counts.
void explain(std::vector<NodePrediction>& prediction, FilterLibrary& library, const RunGraph& graph,
             const RunRecords& records);

}  // namespace scanmill
