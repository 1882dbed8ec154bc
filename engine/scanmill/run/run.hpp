// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Runs a graph with one or more workers. A node whose result is in the cache does not run; every other node runs once.
/// A value is dropped after its last use. An output file appears whole or not at all. If a node fails, the cells that
/// need it fail; other cells go on. The outputs of cells that fail only because an expectation is not met are written
/// to failed_folder().

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
    unsigned threads = 1;  ///< threads for every filter; results do not depend on the number
    Limits limits;
    bool fail_fast = false;  ///< after the first failure, no further task starts but writes to failed_folder()
    std::function<bool()> is_cancelled;
    Cache* cache = nullptr;  ///< null: every node runs and no result is stored
    std::vector<NodePrediction> prediction = {};  ///< from predict(); empty: run() calls it
};

/// Receives the events of a run. All calls come from the thread of run(). Only progress and warnings of InProcessWorker
/// come from other threads.
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
    /// Called before the steps run once more to measure their costs. That pass sends only time_passed().
    virtual void pass_started(unsigned /*pass*/, unsigned /*passes*/) {}
    /// Called several times a second.
    virtual void time_passed() {}
};

/// Runs the graph. Every observer receives every event; observers are called in the order given. Outputs and reports do
/// not depend on the number of workers.
RunReport run(FilterLibrary& library, const RunGraph& graph, Workers& workers, const RunSettings& settings,
              const std::vector<RunObserver*>& observers = {});

}  // namespace scanmill
