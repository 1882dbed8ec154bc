// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Why a step runs that ran before: what of it changed since the last run of the same workflow into this folder.

#include "scanmill/cache/prediction.hpp"
#include "scanmill/records/run_records.hpp"

namespace scanmill {

/// Replaces "it has not run like this" by what differs from the step of the same name on the same scan in the newest
/// run of the workflow that has one: parameters with both values, the filter's version or build, the seed, the scan's
/// content, what an earlier step gives. Where variants have several such steps, the one that differs least counts.
void explain(std::vector<NodePrediction>& prediction, FilterLibrary& library, const RunGraph& graph,
             const RunRecords& records);

}  // namespace scanmill
