// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/run/scheduler.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "scanmill/base/error.hpp"
#include "scanmill/run/components.hpp"
#include "scanmill/run/run.hpp"
#include "scanmill/worker/file_description.hpp"
#include "scanmill/worker/workbench.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

Components components_of(const RunGraph& graph) {
    const std::size_t size = graph.nodes.size();
    std::vector<std::size_t> parent(size);
    std::iota(parent.begin(), parent.end(), std::size_t(0));
    const auto root = [&](std::size_t node) {
        while (parent[node] != node) node = parent[node] = parent[parent[node]];
        return node;
    };
    std::vector<bool> is_taken(size, false);  // a file belongs to the first that reads it
    for (std::size_t node = 0; node < size; ++node)
        for (const NodeInput& input : graph.nodes[node].inputs) {
            if (!graph.nodes[input.node].step) {
                if (is_taken[input.node]) continue;
                is_taken[input.node] = true;
            }
            // The smaller number leads, so that a root is the first of its component.
            const std::size_t a = root(node), b = root(input.node);
            parent[std::max(a, b)] = std::min(a, b);
        }
    Components found{std::vector<std::size_t>(size), 0};
    for (std::size_t node = 0; node < size; ++node)
        found.of_node[node] = root(node) == node ? found.count++ : found.of_node[root(node)];
    return found;
}

Scheduler::Scheduler(FilterLibrary& library, const RunGraph& graph, Workers& workers, const RunSettings& settings,
                     RunObserver& observer)
    : library_(library),
      graph_(graph),
      workers_(workers),
      settings_(settings),
      observer_(observer),
      prediction_(settings.prediction.empty() ? predict(graph, settings.cache) : settings.prediction),
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
        if (!prediction_[node].will_run) nodes_[node].kept = prediction_[node].needed;
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
    return !prediction_[node].will_run && step && !step->expectations.empty();
}

std::vector<Scheduler::Source> Scheduler::sources(const Task& task) const {
    if (task.write > 0) return {writes_[task.write - 1].source};
    std::vector<Source> all;
    const RunNode& node = graph_.nodes[task.node];
    if (prediction_[task.node].will_run)
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
    if (task.write == 0 && !prediction_[task.node].will_run && !only_expects(task.node)) return adopt(task.node);
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
    scanmill::adopt(*prediction_[index].known, graph_.step(node), node.step ? "" : path_prefix(node.leaf.file), report);
    for (const std::string& warning : report.warnings) observer_.node_warning(node, warning);
    JobReport done;
    done.outcome = Outcome::done;
    done.node = std::move(report);
    finish_node(index, std::move(done));
}

// Which worker does what next: something of its own components first, then of one that nobody has begun, then what
// helps another worker.

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
    if (task.write > 0 || !node.step || !prediction_[task.node].will_run || !settings_.cache || node.is_uncacheable)
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

// What a worker is given to do a task.

namespace {

/// The smaller of those that there are; 0 stands for none.
template <class Number>
Number smaller_limit(Number a, Number b) {
    return a > 0 && b > 0 ? std::min(a, b) : std::max(a, b);
}

}  // namespace

u64 Scheduler::memory_limit() const {
    return smaller_limit(settings_.limits.cell_memory, settings_.limits.step_memory);
}

/// What is left to the cell that has the most, and at most what a step may take.
void Scheduler::limit_time(const Task& task, Job& job) const {
    const Limits& limits = settings_.limits;
    job.seconds_limit = limits.step_seconds;
    job.limit_text = fmt::format("the limit of a step is {}", duration_text(limits.step_seconds));
    if (limits.cell_seconds <= 0) return;
    double left = 0.001;
    for (const std::size_t cell : cells_of(task))
        if (!cells_[cell].is_given_up) left = std::max(left, limits.cell_seconds - report_.cells[cell].seconds);
    if (limits.step_seconds > 0 && limits.step_seconds <= left) return;
    job.seconds_limit = left;
    job.limit_text = fmt::format("the limit of a cell is {}, of which {:.3f} s were spent before",
                                 duration_text(limits.cell_seconds), limits.cell_seconds - left);
}

JobInput Scheduler::input_from(const Source& source, const std::string& port) const {
    JobInput input{port, source.node, source.port, {}, {}};
    const RunNode& node = graph_.nodes[source.node];
    if (!node.step) input.leaf = node.leaf;
    if (const std::optional<StepResult>& known = prediction_[source.node].known)
        if (const ResultOutput* output = known->output(source.port)) input.content = output->content;
    return input;
}

std::vector<JobInput> Scheduler::inputs_of(const RunNode& node) const {
    std::vector<JobInput> inputs;
    for (const NodeInput& input : node.inputs) inputs.push_back(input_from({input.node, input.from}, input.port));
    return inputs;
}

JobMemory Scheduler::memory_of(std::size_t index, std::size_t worker) const {
    const RunNode& node = graph_.nodes[index];
    const NodeState& state = nodes_[index];
    JobMemory memory;
    memory.is_used = settings_.cache && !node.is_uncacheable;
    memory.plan_key = node.key;
    memory.code = node.code;
    memory.needed.assign(prediction_[index].needed.begin(), prediction_[index].needed.end());
    const bool is_away = components_[state.component].home != worker;
    memory.keep_always = settings_.shares_values && (is_away || state.uses_left > 1);
    for (const NodeInput& input : node.inputs) memory.inputs_cost += nodes_[input.node].cost;
    return memory;
}

std::string Scheduler::frame_of(std::size_t index) const {
    const RunNode& node = graph_.nodes[index];
    const PlannedStep* step = graph_.step(node);
    return step ? fmt::format("in step '{}' ({}:{}:{})", step->label, graph_.plans[node.plan]->workflow.file,
                              step->position.line, step->position.column)
                : fmt::format("while reading '{}'", node.leaf.file.string());
}

Job Scheduler::job(const Task& task, std::size_t worker) const {
    const RunNode& node = graph_.nodes[task.node];
    const auto step = [&] {
        return std::shared_ptr<const PlannedStep>(graph_.plans[node.plan], graph_.step(node));  // lives with its plan
    };
    Job job;
    job.node = task.node;
    job.threads = settings_.threads;
    job.seed = graph_.seed;
    job.memory_limit = memory_limit();
    limit_time(task, job);
    const std::string on_scan = fmt::format("on scan '{}'", graph_.scan_names[node.scan]);
    if (task.write > 0) {
        const Write& write = writes_[task.write - 1];
        job.work = WriteWork{write.file, made_how(graph_, write.cells, write.source.node, report_.nodes),
                             input_from(write.source, "")};
        job.frames = {fmt::format("while writing '{}'", write.file.string()),
                      fmt::format("on scan '{}'", graph_.scan_names[graph_.cells[write.cells.front()].scan])};
        return job;
    }
    if (!node.step) {
        job.work = ReadWork{node.leaf, memory_of(task.node, worker)};
        if (node.leaf.file != graph_.scan_names[node.scan]) job.frames = {on_scan};
        return job;
    }
    const PlannedStep& planned = *graph_.step(node);
    job.frames = {frame_of(task.node), on_scan};
    if (!prediction_[task.node].will_run) {
        const std::string& primary = planned.spec.outputs.front().name;
        job.work = ExpectWork{step(), prediction_[task.node].known->metrics, input_from({task.node, primary}, primary)};
        return job;
    }
    job.work = StepWork{step(), library_.build_id(planned.spec.name), inputs_of(node), node.parameter_files,
                        memory_of(task.node, worker)};
    return job;
}

// What follows from the end of a task: for the node, for the cells that need it, for who waits for it, and for the
// worker that did it.

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
        if (prediction_[task.node].will_run && !lost_values) here.holds.insert(task.node);
        const bool is_away = components_[component].home != worker;
        finish_node(task.node, std::move(report));
        const std::set<std::string>& needed = prediction_[task.node].needed;
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
    NodePrediction& seen = prediction_[index];
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
        if (done.outcome == Outcome::done) report.properties = std::move(done.node.properties);
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

// What is not there any longer: values that nobody has, and workers. What is needed is made again.

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
        prediction_[source.node].needed.insert(source.port);
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
    NodePrediction& seen = prediction_[index];
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
    prediction_[index].will_run = true;
    prediction_[index].why = why;
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

// What the ends of tasks mean for cells: the time that they take of theirs, and their own end.

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

RunReport run(FilterLibrary& library, const RunGraph& graph, Workers& workers, const RunSettings& settings,
              RunObserver& observer) {
    return Scheduler(library, graph, workers, settings, observer).run();
}

}  // namespace scanmill
