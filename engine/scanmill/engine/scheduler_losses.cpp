// SPDX-License-Identifier: GPL-3.0-or-later
// What is not there any longer: values that nobody has, and workers. What is needed is made again.
#include <algorithm>
#include <cassert>

#include "scanmill/engine/scheduler.hpp"

namespace scanmill {

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

/// Inputs that were believed to be there are not.
void Scheduler::lost(std::size_t worker, const Task& task, const std::vector<JobInput>& inputs) {
    for (const Source& source : sources(task)) {
        const auto is_it = [&](const JobInput& input) {
            return input.node == source.node && input.from == source.port;
        };
        if (std::ranges::none_of(inputs, is_it)) continue;
        nodes_[source.node].kept.erase(source.port);
        if (at_[worker].holds.erase(source.node) > 0) workers_.forget(worker, source.node);
    }
    to_consider_.push_back(task);
}

/// No process can be started for this worker: others take over what is its own.
void Scheduler::gone(std::size_t worker) {
    WorkerState& here = at_[worker];
    const Task task = *here.task;
    leave(worker);
    here.is_gone = true;
    here.holds.clear();
    for (const std::size_t index : here.components) {
        components_[index].home.reset();
        if (!components_[index].ready.empty()) fresh_.insert(index);
    }
    here.components.clear();
    to_consider_.push_back(task);
}

/// Another process takes the worker's place. What it held and nobody kept is made again where it is needed.
void Scheduler::renew(std::size_t worker) {
    at_[worker].worn_by.reset();
    at_[worker].holds.clear();
    workers_.replace(worker);
}

}  // namespace scanmill
