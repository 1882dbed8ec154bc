// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a run prints on stdout: before it, with --dry-run, and after it.

#include <string>

#include "scanmill/cache/prediction.hpp"
#include "scanmill/run/run.hpp"

namespace scanmill::runner {

std::string graph_text(const RunGraph& graph, const std::vector<NodePrediction>& prediction);
std::string graph_json(const RunGraph& graph, const std::vector<NodePrediction>& prediction);

/// A row per cell: points read, the filters' headline metrics, the written mesh's properties, seconds, files.
std::string report_text(const RunGraph& graph, const RunReport& report);
std::string report_json(const RunGraph& graph, const RunReport& report);

}  // namespace scanmill::runner
