// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Explains why a step runs again, by the changes since the last run of the same workflow into this folder.

#include "scanmill/cache/prediction.hpp"
#include "scanmill/records/run_records.hpp"

namespace scanmill {

/// Replaces NodePrediction::why of steps that are not in the cache. The new text lists the differences to the step of
/// the same name on the same scan, in the newest run that has such a step. Differences are parameters with their old
/// and new values, the filter's version or build, the seed, the scan's content, and results of earlier steps. If
/// several variants have such a step, the most similar step counts.
void explain(std::vector<NodePrediction>& prediction, FilterLibrary& library, const RunGraph& graph,
             const RunRecords& records);

}  // namespace scanmill
