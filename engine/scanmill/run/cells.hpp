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
    unsigned failures = 0;  ///< number of attempts that ended by a crash or a limit
};

/// The frame for errors of a node: "in step 'x' (file:line:column)" or "while reading 'file'".
std::string frame_of(const RunGraph& graph, std::size_t node);

class Cells {
public:
    /// `graph`, `limits` and `report` must outlive this object. `on_end` is called with the index of a cell when the
    /// cell's report is complete.
    Cells(const RunGraph& graph, const Limits& limits, RunReport& report, std::function<void(std::size_t)> on_end);

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
    /// Counts the end of a task, which took `seconds`, for these cells. Ends the cells that have no unfinished task.
    void task_ended(const std::vector<std::size_t>& cells, double seconds);
    void end_remaining();

private:
    struct State {
        std::vector<std::size_t> files;  ///< index into files() for each of the cell's outputs
        std::size_t tasks_left = 0;
        bool has_ended = false;
        bool is_out_of_time = false;
    };

    void end(std::size_t cell);
    Failure out_of_time(std::size_t cell) const;

    const RunGraph& graph_;
    const Limits& limits_;
    RunReport& report_;
    std::function<void(std::size_t)> on_end_;
    std::vector<FileToWrite> files_;
    std::vector<std::vector<std::size_t>> cells_of_node_;
    std::vector<State> states_;
};

}  // namespace scanmill
