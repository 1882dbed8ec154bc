// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Appends to the records what a run reports, while it runs.

#include <chrono>
#include <functional>
#include <future>
#include <string>
#include <vector>

#include "scanmill/engine/run.hpp"
#include "scanmill/records/run_records.hpp"

namespace scanmill {

/// Gathers what ends within a second before it writes, so that many small steps cost few syncs; a run that is killed
/// loses what ended in its last second, and the step that it was at. When the records cannot be written, because
/// somebody else has locked them or the disk is full, that is tried again now and then; what could not be written until
/// the end is told, and lost.
class Recorder : public RunObserver {
public:
    using OnWarning = std::function<void(std::string)>;

    /// All must outlive the recorder.
    Recorder(RunRecords& records, const RunStart& start, FilterLibrary& library, const RunGraph& graph,
             OnWarning on_warning);

    ~Recorder() override;

    void node_ended(const RunNode& node, const NodeReport& report) override;
    void cell_ended(const RunCell& cell, const CellReport& report) override;
    void time_passed() override { flush_when_due(); }
    /// The rest, and how the run ended.
    void finish(const RunReport& report);

    /// The run's number; 0 when the records cannot be written.
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

    RunRecords& records_;
    FilterLibrary& library_;
    const RunGraph& graph_;
    OnWarning on_warning_;
    std::future<std::int64_t> beginning_;  // the disk takes its time; the work need not wait for it
    std::int64_t run_ = 0;
    bool broken_ = false;
    std::string trouble_;
    std::vector<StepRecord> steps_;
    std::vector<CellRecord> cells_;
    std::chrono::steady_clock::time_point begin_, flushed_;
};

}  // namespace scanmill
