// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/scheduler.hpp"

#include <algorithm>
#include <cassert>

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

/// The node's values are needed, and nobody has them any longer.
void Scheduler::make_again(std::size_t index, const std::string& why) {
    NodeState& node = nodes_[index];
    assert(node.state != State::running);
    node.state = State::pending;
    node.kept.clear();
    node.failures = 0;
    node.stays_home = true;
    foresight_[index].will_run = true;
    foresight_[index].why = why;
    for (const NodeInput& input : graph_.nodes[index].inputs) ++nodes_[input.node].uses_left;
    ++components_[node.component].tasks_left;
    to_consider_.push_back({index});
}

void Scheduler::hand_out() {
    for (std::size_t worker = 0; worker < at_.size(); ++worker) {
        if (at_[worker].task || at_[worker].is_gone) continue;
        if (busy_ > 0 && !workers_.has_room(memory_limit())) {
            has_changed_ = true;  // memory may be free before anything else happens
            return;
        }
        if (const std::optional<Task> task = next_for(worker)) begin(worker, *task);
    }
}

/// Of its own components first, then of one that nobody has begun, then whatever helps another worker.
std::optional<Scheduler::Task> Scheduler::next_for(std::size_t worker) {
    WorkerState& here = at_[worker];
    if (here.worn_by) {  // what one scan has left behind no other one must meet
        if (const std::optional<Task> task = next_at_home(worker, components_[*here.worn_by])) return task;
        if (!to_consider_.empty()) return std::nullopt;  // it may have more to do in a moment
        renew(worker);
    }
    for (const std::size_t index : std::vector<std::size_t>(here.components.begin(), here.components.end()))
        if (const std::optional<Task> task = next_at_home(worker, components_[index])) return task;
    if (!to_consider_.empty()) return std::nullopt;  // its own components may have more to do in a moment
    while (!fresh_.empty()) {
        const std::size_t index = *fresh_.begin();
        fresh_.erase(fresh_.begin());
        components_[index].home = worker;
        here.components.insert(index);
        if (const std::optional<Task> task = next_at_home(worker, components_[index])) return task;
        if (!to_consider_.empty()) return std::nullopt;
    }
    if (!settings_.cache || !settings_.shares_values || is_helping_useless_) return std::nullopt;
    for (const WorkerState& other : at_)
        for (const std::size_t index : other.components)
            for (const Task& task : components_[index].ready)
                if (may_help(task)) {
                    const Task found = task;
                    components_[index].ready.erase(found);
                    return found;
                }
    return std::nullopt;
}

/// The first that can be begun. What has lost an input waits until that was made again.
std::optional<Scheduler::Task> Scheduler::next_at_home(std::size_t worker, Component& component) {
    for (auto place = component.ready.begin(); place != component.ready.end();) {
        const Task task = *place;
        if (is_being_computed(task)) {
            ++place;
            continue;
        }
        place = component.ready.erase(place);
        if (!is_wanted(task))
            skip(task);
        else if (!lost_input(task, worker))
            return task;
    }
    return std::nullopt;
}

/// When a value that the task needs is nowhere, it is made again, and the task waits for it.
bool Scheduler::lost_input(const Task& task, std::size_t worker) {
    for (const Source& source : sources(task)) {
        if (is_at_hand(source) || at_[worker].holds.contains(source.node)) continue;
        if (source.node == task.node && task.write == 0) {
            ask_no_more(task.node);
            to_consider_.push_back(task);
            return true;
        }
        NodeState& from = nodes_[source.node];
        foresight_[source.node].needed.insert(source.port);
        if (from.state == State::done)
            make_again(source.node, report_.nodes[source.node].origin == Origin::ran
                                        ? "its value was lost, with the worker that held it or by the cache"
                                        : "the cache has lost its value");
        from.waiting.push_back(task);
        return true;
    }
    return false;
}

/// What was only to be asked about is not there any longer, and has to run.
void Scheduler::ask_no_more(std::size_t index) {
    const std::string primary = graph_.step(graph_.nodes[index])->spec.outputs.front().name;
    release({index, primary});
    NodeForesight& seen = foresight_[index];
    seen.needed.insert(primary);
    seen.will_run = true;
    seen.why = "the cache has lost its value";
    for (const NodeInput& input : graph_.nodes[index].inputs) ++nodes_[input.node].uses_left;
}

bool Scheduler::is_kept(const Source& source) const { return nodes_[source.node].kept.contains(source.port); }

/// Any worker can have it: from the cache, or by reading the file again.
bool Scheduler::is_at_hand(const Source& source) const {
    return is_kept(source) || (!graph_.nodes[source.node].step && nodes_[source.node].state == State::done);
}

bool Scheduler::may_help(const Task& task) const {
    const std::vector<Source> all = sources(task);
    return !graph_.nodes[task.node].is_uncacheable && !nodes_[task.node].stays_home && is_wanted(task) &&
           std::ranges::all_of(all, [&](const Source& source) { return is_at_hand(source); }) &&
           !is_being_computed(task);
}

/// Steps of different nodes that do the same on equal inputs: the second takes what the first made.
std::string Scheduler::twin_key(const Task& task) const {
    const RunNode& node = graph_.nodes[task.node];
    if (task.write > 0 || !node.step || !foresight_[task.node].will_run || !settings_.cache || node.is_uncacheable)
        return {};
    const PlannedStep& step = *graph_.step(node);
    return work_key(step, node.code, step.parameters, inputs_of(node));
}

bool Scheduler::is_being_computed(const Task& task) const {
    if (busy_ == 0) return false;
    const std::string key = twin_key(task);
    return !key.empty() && std::ranges::find(at_, key, &WorkerState::twin) != at_.end();
}

void Scheduler::begin(std::size_t worker, const Task& task) {
    WorkerState& here = at_[worker];
    here.task = task;
    here.twin = twin_key(task);
    ++busy_;
    for (const Source& source : sources(task)) here.holds.insert(source.node);
    if (task.write == 0) {
        nodes_[task.node].state = State::running;
        observer_.node_started(graph_.nodes[task.node], worker);
    } else {
        const Write& write = writes_[task.write - 1];
        const RunCell& cell = graph_.cells[write.cells.front()];
        observer_.output_started(cell, *std::ranges::find(cell.outputs, write.file, &RunOutput::file), worker);
    }
    workers_.start(worker, job(task, worker));
}

}  // namespace scanmill
