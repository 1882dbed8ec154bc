// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Appends the reports of a run to the records during the run.

#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/records/run_records.hpp"
#include "scanmill/run/run.hpp"

namespace scanmill {

/// Writes at most once a second, so that many small steps cost few syncs. A killed run loses the rows of its last
/// second. If the database cannot be opened, the run continues unrecorded, with a warning. If the database is locked or
/// the disk is full, the recorder tries again until the end of the run. If the last attempt fails, it warns, and the
/// rows are lost.
class Recorder : public RunObserver {
public:
    using OnWarning = std::function<void(std::string)>;

    /// Creates `file` if needed. `library` and `graph` must outlive the recorder. With `measures_costs`, records the
    /// costs of cells. It must be false if the run uses a cache: then some steps are skipped, and others take longer.
    Recorder(std::filesystem::path file, RunStart start, FilterLibrary& library, const RunGraph& graph,
             OnWarning on_warning, bool measures_costs = false);

    ~Recorder() override;

    void node_ended(const RunNode& node, const NodeReport& report) override;
    void cell_ended(const RunCell& cell, const CellReport& report) override;
    void time_passed() override { flush_when_due(); }
    /// Adds the costs of one more pass. `graph` is the graph of that pass, whose cells are cells of the run.
    void add_pass(const RunGraph& graph, const RunReport& report);
    /// Writes the remaining rows and the outcome of the run.
    void finish(const RunReport& report);

    /// The run's number; 0 if the database cannot be opened.
    std::int64_t run() {
        wait_for_begin();
        return run_;
    }

private:
    void wait_for_begin();
    bool flush();
    void flush_when_due();
    template <class Action>
    bool attempt(Action&& action);
    void warn(std::string text) const;

    FilterLibrary& library_;
    const RunGraph& graph_;
    OnWarning on_warning_;
    std::optional<RunRecords> records_;  // empty if the database could not be opened
    std::int64_t run_ = 0;
    std::string trouble_;
    std::vector<StepRecord> steps_;
    std::vector<CellRecord> cells_;
    std::vector<PastCosts> costs_;  // costs of later passes
    bool measures_costs_;
    std::vector<std::optional<CostRecord>> node_costs_;  // by node; empty for a node that did not run or failed
    std::chrono::steady_clock::time_point begin_, flushed_;
    std::future<void> beginning_;  // opens the database while the first steps run
};

}  // namespace scanmill
