// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Keeps account of the cells during a run: the time that they have used, the number of their unfinished tasks, and
/// their reports.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "scanmill/batch/batch.hpp"
#include "scanmill/cache/run_values.hpp"
#include "scanmill/graph/graph.hpp"
#include "scanmill/worker/job.hpp"
#include "scanmill/worker/report.hpp"

namespace scanmill {

/// An output file, which several cells may share.
struct FileToWrite {
    ValueSlot source;
    std::filesystem::path file;
    std::vector<std::size_t> cells;
    OutputReport report;
    Failure failure;
    double seconds = 0;
    std::filesystem::path evidence;  ///< failed_of() the file, if it is written there; otherwise empty
    unsigned failures = 0;  ///< number of attempts that ended by a crash or a limit
};

/// The frame for errors of a node: "in step 'x' (file:line:column)" or "while reading 'file'".
std::string frame_of(const RunGraph& graph, std::size_t node);

class Cells {
public:
    using OnEnd = std::function<void(std::size_t cell)>;
    using OnNodeWarning = std::function<void(std::size_t node, const std::string& text)>;

    /// `graph`, `limits` and `report` must outlive this object. `on_end` is called with the index of a cell when the
    /// cell's report is complete.
    Cells(const RunGraph& graph, const Limits& limits, RunReport& report, OnEnd on_end, OnNodeWarning on_warning);

    std::vector<FileToWrite>& files() { return files_; }
    const std::vector<FileToWrite>& files() const { return files_; }
    const std::vector<std::size_t>& of_node(std::size_t node) const { return cells_of_node_[node]; }

    /// Whether any of these cells has time left.
    bool have_time(const std::vector<std::size_t>& cells) const;
    /// Sets the time limit of a job to the time left for these cells: that of the cell with the most time left. The
    /// limit of a step is used if it is smaller.
    void limit_time(const std::vector<std::size_t>& cells, Job& job) const;
    /// Adds seconds to the used time of the cells.
    void charge(const std::vector<std::size_t>& cells, double seconds);
    /// Whether all these cells fail because a node does not meet an expectation. Their outputs belong into
    /// failed_folder().
    bool are_unmet(const std::vector<std::size_t>& cells) const;
    /// Warns that an output of the node could not be written to failed_folder(). Only the first call has an effect.
    void warn_of_failed_folder(std::size_t node, const std::string& reason);
    /// Counts the end of a task, which took `seconds`, for these cells. Ends the cells that have no unfinished task. A
    /// cell that may have to move an output waits for the cells that share the output.
    void task_ended(const std::vector<std::size_t>& cells, double seconds);
    void end_remaining();

private:
    struct State {
        std::vector<std::size_t> files;  ///< index into files() for each of the cell's outputs
        std::size_t tasks_left = 0;
        bool has_ended = false;
        bool is_out_of_time = false;
    };

    bool is_unmet(std::size_t cell) const;
    bool must_wait(std::size_t cell) const;
    void move_to_failed(FileToWrite& file);
    void end(std::size_t cell);
    Failure out_of_time(std::size_t cell) const;

    const RunGraph& graph_;
    const Limits& limits_;
    RunReport& report_;
    OnEnd on_end_;
    OnNodeWarning on_warning_;
    bool has_warned_ = false;  // warn_of_failed_folder() was called
    std::vector<FileToWrite> files_;
    std::vector<std::vector<std::size_t>> cells_of_node_;
    std::vector<State> states_;
    std::vector<std::size_t> waiting_;  // cells for which must_wait() was true at their last task
};

}  // namespace scanmill
