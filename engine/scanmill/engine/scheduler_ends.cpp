// SPDX-License-Identifier: GPL-3.0-or-later
// What follows from the end of a task: for the node, for the cells that need it, for who waits for it, and for the
// worker that did it.
#include <algorithm>
#include <cassert>

#include "scanmill/engine/scheduler.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/work/workbench.hpp"

namespace scanmill {

void Scheduler::ended(std::size_t worker, JobReport report, bool lost_values) {
    WorkerState& here = at_[worker];
    assert(here.task);
    const Task task = *here.task;
    const std::size_t component = nodes_[task.node].component;
    leave(worker);
    if (lost_values) {
        here.holds.clear();
        here.worn_by.reset();
    } else if (!report.worn.empty()) {
        here.worn_by = component;
        report.node.effort.log.push_back(fmt::format("scanmill: the worker is replaced: {}", report.worn));
    }
    if (report.was_read_whole)
        report.node.effort.log.push_back("scanmill: the file could not be read piece by piece and was read as a whole");
    if (!report.lost.empty()) return lost(worker, task, report.lost);
    if (report.outcome == Outcome::skipped) {  // cancelled
        report_.interrupted = is_stopped_ = true;
        return;
    }
    unsigned& failures = task.write > 0 ? writes_[task.write - 1].failures : nodes_[task.node].failures;
    const Cause cause = report.node.failure.cause;
    const bool was_ended =
        cause == Cause::signal || cause == Cause::exit || cause == Cause::memory || cause == Cause::time;
    if (was_ended) {
        ++failures;
        if (failures <= settings_.limits.retries) {
            observer_.node_warning(graph_.nodes[task.node],
                                   fmt::format("attempt {} of {} failed: {}", failures, settings_.limits.retries + 1,
                                               report.node.failure.text));
            for (const std::size_t cell : cells_of(task)) charge(cell, report.node.effort.seconds);
            to_consider_.push_back(task);
            return;
        }
    }
    report.node.attempts = failures + !was_ended;
    if (report.outcome == Outcome::failed && settings_.fail_fast) is_stopped_ = true;
    if (task.write > 0) {
        finish_write(task, std::move(report));
    } else {
        if (foresight_[task.node].will_run && !lost_values) here.holds.insert(task.node);
        const bool is_away = components_[component].home != worker;
        finish_node(task.node, std::move(report));
        const std::set<std::string>& needed = foresight_[task.node].needed;
        // Values that cannot be kept do not get home: helping would mean doing things twice. A streamed scan never is
        // kept, for whoever needs it opens its file.
        if (is_away && nodes_[task.node].state == State::done && !graph_.nodes[task.node].leaf.is_streamed &&
            !std::ranges::includes(nodes_[task.node].kept, needed))
            is_helping_useless_ = true;
    }
}

/// The worker does nothing now.
void Scheduler::leave(std::size_t worker) {
    WorkerState& here = at_[worker];
    if (here.task->write == 0) nodes_[here.task->node].state = State::pending;
    here.task.reset();
    here.twin.clear();
    --busy_;
    has_changed_ = true;
}

void Scheduler::finish_node(std::size_t index, JobReport done) {
    const RunNode& node = graph_.nodes[index];
    NodeState& state = nodes_[index];
    NodeForesight& seen = foresight_[index];
    NodeReport& report = report_.nodes[index];
    const Task task{index};
    const std::vector<Source> used = sources(task);
    if (seen.will_run || !only_expects(index)) {
        report = std::move(done.node);
    } else {  // it was known; only asked about
        report = {};
        scanmill::adopt(*seen.known, graph_.step(node), "", report);
        report.attempts = done.node.attempts;
        report.effort = std::move(done.node.effort);
        for (const std::string& warning : report.warnings) observer_.node_warning(node, warning);
        report.origin = Origin::cached;
        report.outcome = done.outcome;
        report.failure = std::move(done.node.failure);
        if (done.outcome == Outcome::done) report.facts = std::move(done.node.facts);
    }
    if (seen.will_run) {
        report.why = seen.why;
        double cost = report.effort.seconds;
        for (const NodeInput& input : node.inputs) cost += nodes_[input.node].cost;
        if (!done.result.outputs.empty()) {
            state.kept = {done.kept.begin(), done.kept.end()};
            const bool all_kept = state.kept.size() == done.result.outputs.size();
            state.cost = all_kept ? 0 : report.origin == Origin::ran ? cost : done.result.seconds;
            seen.known = std::move(done.result);
        } else {
            state.cost = cost;
        }
    }
    state.state = report.outcome == Outcome::done ? State::done : State::failed;
    observer_.node_ended(node, report);
    for (const Source& source : used) release(source);
    for (const Task& waiting : state.waiting) to_consider_.push_back(waiting);
    state.waiting.clear();
    if (state.uses_left == 0) {
        ++state.uses_left;
        release({index, ""});
    }
    task_ended(task);
}

void Scheduler::finish_write(const Task& task, JobReport done) {
    Write& write = writes_[task.write - 1];
    write.failure = std::move(done.node.failure);
    write.seconds = done.node.effort.seconds;
    write.report = std::move(done.output);
    write.report.file = write.file;  // a worker that ended in between told nothing
    if (write.failure) write.report.outcome = Outcome::failed;
    observer_.output_written(graph_.cells[write.cells.front()], write.report);
    release(write.source);
    task_ended(task);
}

void Scheduler::skip(const Task& task) {
    for (const Source& source : sources(task)) release(source);
    if (task.write == 0) {
        NodeState& node = nodes_[task.node];
        node.state = State::skipped;
        if (!node.is_counted) report_.nodes[task.node] = {};
        for (const Task& waiting : node.waiting) to_consider_.push_back(waiting);
        node.waiting.clear();
    }
    task_ended(task);
}

/// The cells hear of it once, even when it has to be done again.
void Scheduler::task_ended(const Task& task) {
    NodeState& node = nodes_[task.node];
    Component& component = components_[node.component];
    if (--component.tasks_left == 0 && component.home) at_[*component.home].components.erase(node.component);
    if (task.write > 0) {
        count_for_cells(cells_of(task), writes_[task.write - 1].seconds);
    } else if (!node.is_counted) {
        node.is_counted = true;
        count_for_cells(node.cells, report_.nodes[task.node].effort.seconds);
    }
}

/// One task less needs the value.
void Scheduler::release(const Source& source) {
    NodeState& node = nodes_[source.node];
    if (node.uses_left > 0) --node.uses_left;
    if (node.uses_left > 0) return;
    for (std::size_t worker = 0; worker < at_.size(); ++worker)
        if (at_[worker].holds.erase(source.node) > 0) workers_.forget(worker, source.node);
}

}  // namespace scanmill
