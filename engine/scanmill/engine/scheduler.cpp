// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/scheduler.hpp"

#include <algorithm>

#include "scanmill/engine/components.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/work/workbench.hpp"

namespace scanmill {

Scheduler::Scheduler(FilterLibrary& library, const RunGraph& graph, Workers& workers, const RunSettings& settings,
                     RunObserver& observer)
    : library_(library),
      graph_(graph),
      workers_(workers),
      settings_(settings),
      observer_(observer),
      foresight_(settings.foresight.empty() ? foresee(graph, settings.cache) : settings.foresight),
      nodes_(graph.nodes.size()),
      cells_(graph.cells.size()),
      writes_of_cell_(graph.cells.size()),
      at_(workers.size()) {
    report_.nodes.resize(graph.nodes.size());
    report_.cells.resize(graph.cells.size());
}

RunReport Scheduler::run() {
    lay_out();
    constexpr std::chrono::milliseconds patience(100);
    const WorkerListener listener{
        [&](std::size_t worker, double fraction) {
            if (at_[worker].task) observer_.node_progress(graph_.nodes[at_[worker].task->node], fraction);
        },
        [&](std::size_t worker, std::string_view text) {
            if (at_[worker].task) observer_.node_warning(graph_.nodes[at_[worker].task->node], text);
        },
        [&](std::size_t worker, JobReport report, bool lost_values) { ended(worker, std::move(report), lost_values); },
        [&](std::size_t worker) { gone(worker); }};
    for (;;) {
        if (!report_.interrupted && settings_.is_cancelled && settings_.is_cancelled()) {
            report_.interrupted = is_stopped_ = true;
            workers_.cancel();
        }
        if (has_changed_) {
            has_changed_ = false;
            consider_all();
            if (!is_stopped_) hand_out();
        }
        const bool is_pressing = !to_consider_.empty();
        has_changed_ = has_changed_ || is_pressing;
        if (busy_ == 0 && to_consider_.empty()) break;
        if (busy_ > 0) workers_.wait(listener, is_pressing ? std::chrono::milliseconds(0) : patience);
        observer_.time_passed();
    }
    skip_the_rest();
    return std::move(report_);
}

/// Who needs what, and everything that is to be done put into the queue.
void Scheduler::lay_out() {
    std::map<std::filesystem::path, std::size_t> write_of_file;
    for (std::size_t cell = 0; cell < graph_.cells.size(); ++cell) {
        const RunCell& of = graph_.cells[cell];
        cells_[cell].tasks_left = of.nodes.size() + of.outputs.size();
        for (const std::size_t node : of.nodes) nodes_[node].cells.push_back(cell);
        for (const RunOutput& output : of.outputs) {
            const auto [known, is_new] = write_of_file.emplace(output.file, writes_.size());
            if (is_new) writes_.push_back({{output.node, output.port}, output.file, {}, {}, {}, 0});
            writes_[known->second].cells.push_back(cell);
            writes_of_cell_[cell].push_back(known->second);
        }
    }
    for (std::size_t node = 0; node < nodes_.size(); ++node) {
        if (!foresight_[node].will_run) nodes_[node].kept = foresight_[node].needed;
        to_consider_.push_back({node});
    }
    for (std::size_t write = 0; write < writes_.size(); ++write)
        to_consider_.push_back({writes_[write].source.node, write + 1});
    for (const Task& task : to_consider_)
        for (const Source& source : sources(task)) ++nodes_[source.node].uses_left;
    std::ranges::sort(to_consider_);
    const Components found = components_of(graph_);
    components_.resize(found.count);
    for (std::size_t node = 0; node < nodes_.size(); ++node) nodes_[node].component = found.of_node[node];
    for (const Task& task : to_consider_) ++components_[nodes_[task.node].component].tasks_left;
}

/// The node's result is known, and only what it is expected to be has to be asked.
bool Scheduler::only_expects(std::size_t node) const {
    const PlannedStep* step = graph_.step(graph_.nodes[node]);
    return !foresight_[node].will_run && step && !step->expectations.empty();
}

std::vector<Scheduler::Source> Scheduler::sources(const Task& task) const {
    if (task.write > 0) return {writes_[task.write - 1].source};
    std::vector<Source> all;
    const RunNode& node = graph_.nodes[task.node];
    if (foresight_[task.node].will_run)
        for (const NodeInput& input : node.inputs) all.push_back({input.node, input.from});
    else if (only_expects(task.node))
        all.push_back({task.node, graph_.step(node)->spec.outputs.front().name});
    return all;
}

/// What must have gone well before: also where the result is known, for it stands on theirs.
std::vector<std::size_t> Scheduler::prerequisites(const Task& task) const {
    if (task.write > 0) return {writes_[task.write - 1].source.node};
    std::vector<std::size_t> all;
    for (const NodeInput& input : graph_.nodes[task.node].inputs) all.push_back(input.node);
    return all;
}

void Scheduler::consider_all() {
    while (!to_consider_.empty() && !is_stopped_) {
        const Task task = to_consider_.front();
        to_consider_.pop_front();
        consider(task);
    }
    if (is_stopped_) to_consider_.clear();
}

/// The task is ready, waits for a node, or has no hope.
void Scheduler::consider(const Task& task) {
    if (!is_wanted(task)) return skip(task);
    for (const std::size_t index : prerequisites(task)) {
        NodeState& from = nodes_[index];
        if (from.state == State::failed || from.state == State::skipped) return skip(task);
        if (from.state != State::done) {
            from.waiting.push_back(task);
            return;
        }
    }
    if (task.write == 0 && !foresight_[task.node].will_run && !only_expects(task.node)) return adopt(task.node);
    const std::size_t index = nodes_[task.node].component;
    components_[index].ready.insert(task);
    if (!components_[index].home) fresh_.insert(index);
}

/// Whether any cell still has time for it.
bool Scheduler::is_wanted(const Task& task) const {
    return std::ranges::any_of(cells_of(task), [&](std::size_t cell) { return !cells_[cell].is_given_up; });
}

void Scheduler::adopt(std::size_t index) {
    const RunNode& node = graph_.nodes[index];
    NodeReport report;
    report.origin = Origin::cached;
    report.outcome = Outcome::done;
    scanmill::adopt(*foresight_[index].known, graph_.step(node), node.step ? "" : said_of(node.leaf.file), report);
    for (const std::string& warning : report.warnings) observer_.node_warning(node, warning);
    JobReport done;
    done.outcome = Outcome::done;
    done.node = std::move(report);
    finish_node(index, std::move(done));
}

}  // namespace scanmill
