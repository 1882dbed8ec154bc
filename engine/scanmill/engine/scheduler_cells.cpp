// SPDX-License-Identifier: GPL-3.0-or-later
// What the ends of tasks mean for cells: the time that they take of theirs, and their own end.
#include <algorithm>
#include <cassert>

#include "scanmill/engine/duration.hpp"
#include "scanmill/engine/scheduler.hpp"
#include "scanmill/filter/error.hpp"

namespace scanmill {

namespace {

/// A scan may fail by what was done for another one of equal content.
void name_scan(std::string& text, const std::string& done_for, const std::string& scan) {
    const std::string frame = fmt::format("on scan '{}'", done_for);
    if (const std::size_t place = text.find(frame); done_for != scan && place != std::string::npos)
        text.replace(place, frame.size(), fmt::format("on scan '{}', which equals '{}'", scan, done_for));
}

}  // namespace

void Scheduler::count_for_cells(const std::vector<std::size_t>& cells, double seconds) {
    for (const std::size_t cell : cells) {
        charge(cell, seconds);
        if (--cells_[cell].tasks_left == 0) end_cell(cell);
    }
}

void Scheduler::charge(std::size_t cell, double seconds) {
    report_.cells[cell].seconds += seconds;
    const double limit = settings_.limits.cell_seconds;
    if (limit > 0 && report_.cells[cell].seconds > limit) cells_[cell].is_given_up = true;
}

void Scheduler::end_cell(std::size_t index) {
    const RunCell& cell = graph_.cells[index];
    CellReport& report = report_.cells[index];
    cells_[index].has_ended = true;
    bool is_done = true;
    for (const std::size_t node : cell.nodes) {
        is_done = is_done && report_.nodes[node].outcome == Outcome::done;
        if (!report.failure && report_.nodes[node].failure) {
            report.failure = report_.nodes[node].failure;
            name_scan(report.failure.text, graph_.scan_names[graph_.nodes[node].scan], graph_.scan_names[cell.scan]);
        }
    }
    for (const std::size_t index_of_write : writes_of_cell_[index]) {
        const Write& write = writes_[index_of_write];
        is_done = is_done && write.report.outcome == Outcome::done;
        if (!report.failure) report.failure = write.failure;
        report.outputs.push_back(write.report);
        report.outputs.back().file = write.file;
    }
    if (!report.failure && cells_[index].is_given_up && !is_done) report.failure = out_of_time(index);
    report.outcome = report.failure ? Outcome::failed : is_done ? Outcome::done : Outcome::skipped;
    observer_.cell_ended(cell, report);
}

/// Of a cell that was given up, with the first that it did not come to.
Failure Scheduler::out_of_time(std::size_t index) const {
    const RunCell& cell = graph_.cells[index];
    Error error("the time did not suffice: the limit of a cell is {}, {:.3f} s were spent and this is not done",
                duration_text(settings_.limits.cell_seconds), report_.cells[index].seconds);
    const auto left = std::ranges::find_if(
        cell.nodes, [&](std::size_t node) { return report_.nodes[node].outcome != Outcome::done; });
    if (left != cell.nodes.end())
        error.add_frame(frame_of(*left));
    else
        for (const OutputReport& output : report_.cells[index].outputs)
            if (output.outcome != Outcome::done) {
                error.add_frame(fmt::format("while writing '{}'", output.file.string()));
                break;
            }
    error.add_frame(fmt::format("on scan '{}'", graph_.scan_names[cell.scan]));
    return {Cause::time, 0, std::move(error).hint("raise the limit, or thin the scan first").what()};
}

const std::vector<std::size_t>& Scheduler::cells_of(const Task& task) const {
    return task.write > 0 ? writes_[task.write - 1].cells : nodes_[task.node].cells;
}

void Scheduler::skip_the_rest() {
    assert(is_stopped_ || std::ranges::all_of(cells_, &CellState::has_ended));
    for (std::size_t cell = 0; cell < cells_.size(); ++cell)
        if (!cells_[cell].has_ended) end_cell(cell);
}

}  // namespace scanmill
