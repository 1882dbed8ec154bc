// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Runs a graph with one or more workers. Each node runs at most once, and not at all if the cache has its result.
/// Values are dropped after their last use; outputs appear whole or not at all. A failed node fails the cells that need
/// it; other cells go on.

#include <functional>
#include <string>
#include <vector>

#include "scanmill/batch/batch.hpp"
#include "scanmill/cache/cache.hpp"
#include "scanmill/cache/prediction.hpp"
#include "scanmill/graph/graph.hpp"
#include "scanmill/worker/report.hpp"
#include "scanmill/worker/workers.hpp"

namespace scanmill {

struct RunSettings {
    unsigned threads = 1;  ///< for every filter; results do not depend on it
    Limits limits;
    bool fail_fast = false;  ///< starts nothing new once a cell has failed
    std::function<bool()> is_cancelled;
    Cache* cache = nullptr;  ///< null: everything is computed, nothing is stored
    std::vector<NodePrediction> prediction = {};  ///< from predict(); empty: run() calls it
};

/// Receives the events of a run. All calls come from the thread of run(), except progress and warnings of a worker in
/// this process.
class RunObserver {
public:
    virtual ~RunObserver() = default;
    virtual void node_started(const RunNode&, std::size_t /*worker*/) {}
    virtual void node_progress(const RunNode&, double /*fraction*/) {}
    virtual void node_warning(const RunNode&, std::string_view /*text*/) {}
    virtual void node_ended(const RunNode&, const NodeReport&) {}
    virtual void output_started(const RunCell&, const RunOutput&, std::size_t /*worker*/) {}
    virtual void output_written(const RunCell&, const OutputReport&) {}
    virtual void cell_ended(const RunCell&, const CellReport&) {}
    /// The steps run once more, to measure what they cost; without further events.
    virtual void pass_started(unsigned /*pass*/, unsigned /*passes*/) {}
    /// Called several times a second.
    virtual void time_passed() {}
};

/// Every observer receives every event, in the order given. Outputs and reports do not depend on the number of workers.
RunReport run(FilterLibrary& library, const RunGraph& graph, Workers& workers, const RunSettings& settings,
              const std::vector<RunObserver*>& observers = {});

}  // namespace scanmill
