// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Running a graph: every node at most once, by one or more workers, what the cache knows not at all. Values are
/// dropped after their last use, outputs written whole or not at all. A failing node fails the cells that need it;
/// everything else goes on.

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
    bool fail_fast = false;  ///< nothing new is begun once a cell has failed
    std::function<bool()> is_cancelled;
    Cache* cache = nullptr;  ///< none: everything is computed, nothing is kept
    /// Values that several steps wait for are kept whatever that costs: other workers can then help out, and a crash
    /// in one step takes nothing from the others.
    bool shares_values = false;
    std::vector<NodePrediction> prediction = {};  ///< when it is known already
};

/// Told of what happens while it happens. Every call comes from the running thread, but progress and warnings of a
/// worker in this process.
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
    /// Several times a second while something runs.
    virtual void time_passed() {}
};

/// Outputs and what is said of them do not depend on the number of workers.
RunReport run(FilterLibrary& library, const RunGraph& graph, Workers& workers, const RunSettings& settings,
              RunObserver& observer);

// Several observers of one run.

/// Tells each of them everything, in the order given. They must outlive it.
class Observers : public RunObserver {
public:
    explicit Observers(std::vector<RunObserver*> all) : all_(std::move(all)) {}

    void node_started(const RunNode& node, std::size_t worker) override {
        for (RunObserver* one : all_) one->node_started(node, worker);
    }
    void node_progress(const RunNode& node, double fraction) override {
        for (RunObserver* one : all_) one->node_progress(node, fraction);
    }
    void node_warning(const RunNode& node, std::string_view text) override {
        for (RunObserver* one : all_) one->node_warning(node, text);
    }
    void node_ended(const RunNode& node, const NodeReport& report) override {
        for (RunObserver* one : all_) one->node_ended(node, report);
    }
    void output_started(const RunCell& cell, const RunOutput& output, std::size_t worker) override {
        for (RunObserver* one : all_) one->output_started(cell, output, worker);
    }
    void output_written(const RunCell& cell, const OutputReport& report) override {
        for (RunObserver* one : all_) one->output_written(cell, report);
    }
    void cell_ended(const RunCell& cell, const CellReport& report) override {
        for (RunObserver* one : all_) one->cell_ended(cell, report);
    }
    void time_passed() override {
        for (RunObserver* one : all_) one->time_passed();
    }

private:
    std::vector<RunObserver*> all_;
};

}  // namespace scanmill
