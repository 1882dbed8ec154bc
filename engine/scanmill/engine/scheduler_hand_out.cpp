// SPDX-License-Identifier: GPL-3.0-or-later
// Which worker does what next: something of its own components first, then of one that nobody has begun, then what
// helps another worker.
#include <algorithm>

#include "scanmill/engine/scheduler.hpp"

namespace scanmill {

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
