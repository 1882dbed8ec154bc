// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Appends to the records what a run reports, while it runs.

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

/// Gathers what ends within a second before it writes, so that many small steps cost few syncs; a run that is killed
/// loses what ended in its last second, and the step that it was at. When the records cannot be opened, the run is not
/// recorded, which is told. When they cannot be written, because somebody else has locked them or the disk is full,
/// that is tried again now and then; what could not be written until the end is told, and lost.
class Recorder : public RunObserver {
public:
    using OnWarning = std::function<void(std::string)>;

    /// `file` need not be there yet. Library and graph must outlive the recorder.
    Recorder(std::filesystem::path file, RunStart start, FilterLibrary& library, const RunGraph& graph,
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
    void warn(std::string text) const;

    FilterLibrary& library_;
    const RunGraph& graph_;
    OnWarning on_warning_;
    std::optional<RunRecords> records_;  // nothing when they could not be opened
    std::int64_t run_ = 0;
    std::string trouble_;
    std::vector<StepRecord> steps_;
    std::vector<CellRecord> cells_;
    std::chrono::steady_clock::time_point begin_, flushed_;
    std::future<void> beginning_;  // the disk takes its time; the work need not wait for it
};

}  // namespace scanmill
