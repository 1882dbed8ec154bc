// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/run/cells.hpp"

#include <algorithm>
#include <map>

#include "scanmill/base/error.hpp"
#include "scanmill/graph/output_files.hpp"
#include "scanmill/worker/file_description.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

std::string frame_of(const RunGraph& graph, std::size_t index) {
    const RunNode& node = graph.nodes[index];
    const PlannedStep* step = graph.step(node);
    if (!step) return fmt::format("while reading '{}'", node.leaf.name());
    if (step->position.line == 0)
        return fmt::format("in step '{}'", step->label);  // the step does not come from a file
    return fmt::format("in step '{}' ({}:{}:{})", step->label,
                       step->file.empty() ? graph.plans[node.plan]->workflow.file : step->file, step->position.line,
                       step->position.column);
}

Cells::Cells(const RunGraph& graph, const Limits& limits, RunReport& report, OnEnd on_end, OnNodeWarning on_warning)
    : graph_(graph),
      limits_(limits),
      report_(report),
      on_end_(std::move(on_end)),
      on_warning_(std::move(on_warning)),
      cells_of_node_(graph.nodes.size()),
      states_(graph.cells.size()) {
    report_.cells.resize(graph.cells.size());
    std::map<std::filesystem::path, std::size_t> indices;
    for (std::size_t index = 0; index < graph.cells.size(); ++index) {
        const RunCell& cell = graph.cells[index];
        states_[index].tasks_left = cell.nodes.size() + cell.outputs.size();
        for (const std::size_t node : cell.nodes) cells_of_node_[node].push_back(index);
        for (const RunOutput& output : cell.outputs) {
            const auto [found, is_new] = indices.emplace(output.file, files_.size());
            if (is_new) files_.push_back({{output.node, output.port}, output.file, {}, {}, {}, 0, {}, 0});
            files_[found->second].cells.push_back(index);
            states_[index].files.push_back(found->second);
        }
    }
}

bool Cells::have_time(const std::vector<std::size_t>& cells) const {
    return std::ranges::any_of(cells, [&](std::size_t cell) { return !states_[cell].is_out_of_time; });
}

void Cells::limit_time(const std::vector<std::size_t>& cells, Job& job) const {
    job.seconds_limit = limits_.step_seconds;
    job.limit_text = fmt::format("the limit of a step is {}", duration_text(limits_.step_seconds));
    if (limits_.cell_seconds <= 0) return;
    double left = 0.001;
    for (const std::size_t cell : cells)
        if (!states_[cell].is_out_of_time) left = std::max(left, limits_.cell_seconds - report_.cells[cell].seconds);
    if (limits_.step_seconds > 0 && limits_.step_seconds <= left) return;
    job.seconds_limit = left;
    job.limit_text = fmt::format("the limit of a cell is {}, of which {:.3f} s were used before",
                                 duration_text(limits_.cell_seconds), limits_.cell_seconds - left);
}

void Cells::charge(const std::vector<std::size_t>& cells, double seconds) {
    for (const std::size_t cell : cells) {
        double& used = report_.cells[cell].seconds;
        used += seconds;
        if (limits_.cell_seconds > 0 && used > limits_.cell_seconds) states_[cell].is_out_of_time = true;
    }
}

void Cells::task_ended(const std::vector<std::size_t>& cells, double seconds) {
    charge(cells, seconds);
    for (const std::size_t cell : cells) {
        if (--states_[cell].tasks_left > 0) continue;
        if (must_wait(cell))
            waiting_.push_back(cell);
        else
            end(cell);
        for (std::size_t i = 0; i < waiting_.size();) {
            const std::size_t other = waiting_[i];
            if (must_wait(other)) {
                ++i;
                continue;
            }
            waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(i));
            end(other);
        }
    }
}

bool Cells::is_unmet(std::size_t cell) const {
    return std::ranges::any_of(graph_.cells[cell].nodes, [&](std::size_t node) {
        return report_.nodes[node].failure.cause == Cause::expectation;
    });
}

bool Cells::are_unmet(const std::vector<std::size_t>& cells) const {
    return std::ranges::all_of(cells, [&](std::size_t cell) { return is_unmet(cell); });
}

/// Whether the cell shares a written output with a cell that is not done, so that it is open whether the output belongs
/// into failed_folder().
bool Cells::must_wait(std::size_t cell) const {
    if (!is_unmet(cell)) return false;
    return std::ranges::any_of(states_[cell].files, [&](std::size_t file) {
        return files_[file].report.outcome == Outcome::ok &&
               std::ranges::any_of(files_[file].cells, [&](std::size_t other) {
                   return states_[other].tasks_left > 0 && !is_unmet(other);
               });
    });
}

void Cells::warn_of_failed_folder(std::size_t node, const std::string& reason) {
    if (has_warned_) return;
    has_warned_ = true;
    on_warning_(node, fmt::format("outputs of failed cells cannot be written to '{}': {}",
                                  failed_folder(graph_.output_folder).string(), reason));
}

void Cells::end_remaining() {
    for (std::size_t cell = 0; cell < states_.size(); ++cell)
        if (!states_[cell].has_ended) end(cell);
}

namespace {

/// Moves the file of an earlier run aside, so that it does not look like the result of this failed run.
void set_aside(OutputReport& output) {
    try {
        if (move_aside(output.file)) output.moved_to = previous_of(output.file);
    } catch (const Error& error) {
        output.not_moved = error.sentence();
    }
}

}  // namespace

/// Moves an output that was written before an expectation was not met. If it cannot be moved, it stays, with a warning.
void Cells::move_to_failed(FileToWrite& file) {
    const std::filesystem::path evidence = failed_of(graph_.output_folder, file.file);
    try {
        move_with_description(file.file, evidence, unmet_by(file.cells, graph_, report_.nodes));
    } catch (const Error& error) {
        return warn_of_failed_folder(file.source.first, error.sentence());
    }
    file.report.outcome = Outcome::failed;
    file.report.evidence = evidence;
}

void Cells::end(std::size_t index) {
    const RunCell& cell = graph_.cells[index];
    CellReport& report = report_.cells[index];
    states_[index].has_ended = true;
    bool is_done = true;
    for (const std::size_t node : cell.nodes) {
        is_done = is_done && report_.nodes[node].outcome == Outcome::ok;
        if (report.failure || !report_.nodes[node].failure) continue;
        report.failure = report_.nodes[node].failure;
        report.failed_node = node;
        const std::string &own = graph_.scan_names[cell.scan], &used = graph_.scan_names[graph_.nodes[node].scan];
        if (own != used) {
            report.failure.scan = own;
            report.failure.equal_scan = used;
        }
    }
    for (const std::size_t file : states_[index].files) {
        is_done = is_done && files_[file].report.outcome == Outcome::ok;
        if (!report.failure) report.failure = files_[file].failure;
    }
    if (!report.failure && states_[index].is_out_of_time && !is_done) report.failure = out_of_time(index);
    report.doubts = doubts_about(cell.outputs, cell.nodes, graph_, report_.nodes);
    const bool is_unmet_now = is_unmet(index);
    for (const std::size_t file : states_[index].files) {
        OutputReport& output = files_[file].report;
        output.file = files_[file].file;
        if (is_unmet_now && output.outcome == Outcome::ok && are_unmet(files_[file].cells))
            move_to_failed(files_[file]);
        if (report.failure && output.outcome != Outcome::ok) set_aside(output);
        // What an earlier run left in failed_folder() is out of date.
        if (is_unmet_now ? output.evidence.empty() : !report.failure && output.outcome == Outcome::ok)
            remove_failed(graph_.output_folder, output.file);
        for (const std::string& doubt : output.doubts)
            report.doubts.push_back(fmt::format("'{}': {}", output.file.string(), doubt));
        report.outputs.push_back(output);
    }
    report.outcome = report.failure          ? Outcome::failed
                     : !is_done              ? Outcome::skipped
                     : report.doubts.empty() ? Outcome::ok
                                             : Outcome::doubtful;
    on_end_(index);
}

/// The failure of a cell that is out of time. The error's frame names the first node or output that is not done.
Failure Cells::out_of_time(std::size_t index) const {
    const RunCell& cell = graph_.cells[index];
    Error error("time limit exceeded: the limit of a cell is {}, {:.3f} s were used and this task is not done",
                duration_text(limits_.cell_seconds), report_.cells[index].seconds);
    const auto node =
        std::ranges::find_if(cell.nodes, [&](std::size_t each) { return report_.nodes[each].outcome != Outcome::ok; });
    const auto file = std::ranges::find_if(
        states_[index].files, [&](std::size_t each) { return files_[each].report.outcome != Outcome::ok; });
    if (node != cell.nodes.end())
        error.add_frame(frame_of(graph_, *node));
    else if (file != states_[index].files.end())
        error.add_frame(fmt::format("while writing '{}'", files_[*file].file.string()));
    error.set_hint("raise the limit, or thin the scan first");
    return {Cause::time, 0, std::move(error), graph_.scan_names[cell.scan], {}};
}

}  // namespace scanmill
