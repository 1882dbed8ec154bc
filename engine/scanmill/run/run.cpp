// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/run/run.hpp"

#include <algorithm>
#include <cassert>
#include <deque>
#include <map>
#include <set>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/graph/output_files.hpp"
#include "scanmill/worker/file_description.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

namespace {

/// The smaller limit; 0: none.
template <class Number>
Number smaller_limit(Number a, Number b) {
    return a > 0 && b > 0 ? std::min(a, b) : std::max(a, b);
}

/// Decides in which order nodes run and outputs are written, for any number of workers.
///
/// Nodes that depend on each other, directly or not, form a component: usually one scan under all its variants. The
/// worker that begins a component owns it and passes values from step to step in memory. A worker without a component
/// takes over steps of others whose inputs are in the cache. So values are not copied as long as there are enough
/// scans. Values that are lost with a worker or the cache are computed again.
class Scheduler {
public:
    Scheduler(FilterLibrary& library, const RunGraph& graph, Workers& workers, const RunSettings& settings,
              const std::vector<RunObserver*>& observers)
        : library_(library),
          graph_(graph),
          workers_(workers),
          settings_(settings),
          observers_(observers),
          prediction_(settings.prediction.empty() ? predict(graph, settings.cache) : settings.prediction),
          nodes_(graph.nodes.size()),
          cells_(graph.cells.size()),
          writes_of_cell_(graph.cells.size()),
          states_(workers.size()) {
        report_.nodes.resize(graph.nodes.size());
        report_.cells.resize(graph.cells.size());
    }

    RunReport run() {
        lay_out();
        constexpr std::chrono::milliseconds patience(100);
        const WorkerListener listener{
            [&](std::size_t worker, double fraction) {
                if (states_[worker].task)
                    notify(&RunObserver::node_progress, graph_.nodes[states_[worker].task->node], fraction);
            },
            [&](std::size_t worker, std::string_view text) {
                if (states_[worker].task)
                    notify(&RunObserver::node_warning, graph_.nodes[states_[worker].task->node], text);
            },
            [&](std::size_t worker, JobReport report, bool lost_values) {
                ended(worker, std::move(report), lost_values);
            },
            [&](std::size_t worker) { start_failed(worker); }};
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
            const bool has_more = !to_consider_.empty();
            has_changed_ = has_changed_ || has_more;
            if (busy_ == 0 && to_consider_.empty()) break;
            if (busy_ > 0) workers_.wait(listener, has_more ? std::chrono::milliseconds(0) : patience);
            notify(&RunObserver::time_passed);
        }
        end_remaining_cells();
        return std::move(report_);
    }

private:
    /// Runs a node, or writes one of its outputs. Tasks are sorted as the nodes of the graph, writes after their node.
    struct Task {
        std::size_t node;
        std::size_t write = 0;  ///< 0: the node itself; else 1 + index into writes_
        auto operator<=>(const Task&) const = default;
    };
    struct Source {
        std::size_t node;
        std::string port;
    };
    enum class State { pending, running, done, failed, skipped };
    struct Write {
        Source source;
        std::filesystem::path file;
        std::vector<std::size_t> cells;
        OutputReport report;
        Failure failure;
        double seconds = 0;
        unsigned failures = 0;
    };
    struct NodeState {
        State state = State::pending;
        bool is_counted = false;  ///< its cells have counted its end
        unsigned failures = 0;  ///< attempts that ended with their worker
        bool stays_with_owner = false;  ///< its values were lost once: other workers do not take it over
        std::size_t uses_left = 0;  ///< unfinished tasks that need its values
        std::size_t component = 0;
        double cost = 0;  ///< seconds to compute its values again; 0 if the cache has them
        std::set<std::string> kept;  ///< ports whose values the cache has
        std::vector<Task> waiting;  ///< tasks that start when it has ended
        std::vector<std::size_t> cells;
    };
    struct CellState {
        std::size_t tasks_left = 0;
        bool has_ended = false;
        bool is_out_of_time = false;
    };
    struct Component {
        std::optional<std::size_t> owner;  ///< a worker
        std::set<Task> ready;
        std::size_t tasks_left = 0;
    };
    struct WorkerState {
        std::optional<Task> task;
        std::string computation;  ///< computation_key() of the task
        std::set<std::size_t> holds;  ///< nodes whose values it has in memory
        std::set<std::size_t> components;  ///< that it owns
        std::optional<std::size_t> replaced_after;  ///< the component after which the worker is replaced
        bool cannot_start = false;
    };

    template <class... Parameters, class... Arguments>
    void notify(void (RunObserver::*event)(Parameters...), const Arguments&... arguments) const {
        for (RunObserver* observer : observers_) (observer->*event)(arguments...);
    }

    /// Counts the uses of every value, finds the components, and queues all tasks.
    void lay_out() {
        std::map<std::filesystem::path, std::size_t> write_of_file;
        for (std::size_t cell = 0; cell < graph_.cells.size(); ++cell) {
            const RunCell& of = graph_.cells[cell];
            cells_[cell].tasks_left = of.nodes.size() + of.outputs.size();
            for (const std::size_t node : of.nodes) nodes_[node].cells.push_back(cell);
            for (const RunOutput& output : of.outputs) {
                const auto [found, is_new] = write_of_file.emplace(output.file, writes_.size());
                if (is_new) writes_.push_back({{output.node, output.port}, output.file, {}, {}, {}, 0});
                writes_[found->second].cells.push_back(cell);
                writes_of_cell_[cell].push_back(found->second);
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
        DisjointSets sets(nodes_.size());
        std::vector<bool> is_joined(nodes_.size());  // a file joins only its first reader: others can read it again
        for (std::uint32_t node = 0; node < nodes_.size(); ++node)
            for (const NodeInput& input : graph_.nodes[node].inputs) {
                if (!graph_.nodes[input.node].step && is_joined[input.node]) continue;
                is_joined[input.node] = true;
                sets.unite(node, static_cast<std::uint32_t>(input.node));
            }
        for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
            const std::uint32_t first = sets.find(node);  // the smallest node of the component
            if (first == node) components_.emplace_back();
            nodes_[node].component = first == node ? components_.size() - 1 : nodes_[first].component;
        }
        for (const Task& task : to_consider_) ++components_[nodes_[task.node].component].tasks_left;
    }

    /// Whether the result is in the cache and only its expectations have to be checked.
    bool only_expects(std::size_t node) const {
        const PlannedStep* step = graph_.step(graph_.nodes[node]);
        return !prediction_[node].will_run && step && !step->expectations.empty();
    }

    std::vector<Source> sources(const Task& task) const {
        if (task.write > 0) return {writes_[task.write - 1].source};
        std::vector<Source> all;
        const RunNode& node = graph_.nodes[task.node];
        if (prediction_[task.node].will_run)
            for (const NodeInput& input : node.inputs) all.push_back({input.node, input.from});
        else if (only_expects(task.node))
            all.push_back({task.node, graph_.step(node)->spec.outputs.front().name});
        return all;
    }

    /// Nodes that must be done before, also if the result is in the cache.
    std::vector<std::size_t> prerequisites(const Task& task) const {
        if (task.write > 0) return {writes_[task.write - 1].source.node};
        std::vector<std::size_t> all;
        for (const NodeInput& input : graph_.nodes[task.node].inputs) all.push_back(input.node);
        return all;
    }

    void consider_all() {
        while (!to_consider_.empty() && !is_stopped_) {
            const Task task = to_consider_.front();
            to_consider_.pop_front();
            consider(task);
        }
        if (is_stopped_) to_consider_.clear();
    }

    /// Makes the task ready, lets it wait for a node, or skips it.
    void consider(const Task& task) {
        if (!has_time(task)) return skip(task);
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
        if (!components_[index].owner) unowned_.insert(index);
    }

    /// Whether any of its cells has time left.
    bool has_time(const Task& task) const {
        return std::ranges::any_of(cells_of(task), [&](std::size_t cell) { return !cells_[cell].is_out_of_time; });
    }

    void adopt(std::size_t index) {
        const RunNode& node = graph_.nodes[index];
        NodeReport report;
        report.origin = Origin::cached;
        report.outcome = Outcome::ok;
        scanmill::adopt(*prediction_[index].cached, graph_.step(node), node.step ? "" : path_prefix(node.leaf.file),
                        report);
        for (const std::string& warning : report.warnings) notify(&RunObserver::node_warning, node, warning);
        JobReport done;
        done.outcome = Outcome::ok;
        done.node = std::move(report);
        finish_node(index, std::move(done));
    }

    void hand_out() {
        for (std::size_t worker = 0; worker < states_.size(); ++worker) {
            if (states_[worker].task || states_[worker].cannot_start) continue;
            if (busy_ > 0 && !workers_.has_room(memory_limit())) {
                has_changed_ = true;  // memory may become free without an event
                return;
            }
            if (const std::optional<Task> task = next_for(worker)) begin(worker, *task);
        }
    }

    /// A task of the worker's own components, else of an unowned component, else of another worker's component.
    std::optional<Task> next_for(std::size_t worker) {
        WorkerState& state = states_[worker];
        if (state.replaced_after) {  // other components get a new worker
            if (const std::optional<Task> task = next_of(worker, components_[*state.replaced_after])) return task;
            if (!to_consider_.empty()) return std::nullopt;  // the component may get ready tasks
            replace(worker);
        }
        for (const std::size_t index : std::vector<std::size_t>(state.components.begin(), state.components.end()))
            if (const std::optional<Task> task = next_of(worker, components_[index])) return task;
        if (!to_consider_.empty()) return std::nullopt;  // its components may get ready tasks
        while (!unowned_.empty()) {
            const std::size_t index = *unowned_.begin();
            unowned_.erase(unowned_.begin());
            components_[index].owner = worker;
            state.components.insert(index);
            if (const std::optional<Task> task = next_of(worker, components_[index])) return task;
            if (!to_consider_.empty()) return std::nullopt;
        }
        if (!settings_.cache || !settings_.shares_values || is_takeover_useless_) return std::nullopt;
        for (const WorkerState& other : states_)
            for (const std::size_t index : other.components)
                for (const Task& task : components_[index].ready)
                    if (can_take_over(task)) {
                        const Task found = task;
                        components_[index].ready.erase(found);
                        return found;
                    }
        return std::nullopt;
    }

    /// The first task that can start. A task with a lost input waits until the input is computed again.
    std::optional<Task> next_of(std::size_t worker, Component& component) {
        for (auto next = component.ready.begin(); next != component.ready.end();) {
            const Task task = *next;
            if (is_being_computed(task)) {
                ++next;
                continue;
            }
            next = component.ready.erase(next);
            if (!has_time(task))
                skip(task);
            else if (!lost_input(task, worker))
                return task;
        }
        return std::nullopt;
    }

    bool is_kept(const Source& source) const { return nodes_[source.node].kept.contains(source.port); }

    /// Whether every worker can get the value, from the cache or its file.
    bool is_available(const Source& source) const {
        return is_kept(source) || (!graph_.nodes[source.node].step && nodes_[source.node].state == State::done);
    }

    bool can_take_over(const Task& task) const {
        const std::vector<Source> all = sources(task);
        return !graph_.nodes[task.node].is_uncacheable && !nodes_[task.node].stays_with_owner && has_time(task) &&
               std::ranges::all_of(all, [&](const Source& source) { return is_available(source); }) &&
               !is_being_computed(task);
    }

    /// Equal for tasks of different nodes that give the same result: the second waits and takes it from the cache.
    std::string computation_key(const Task& task) const {
        const RunNode& node = graph_.nodes[task.node];
        if (task.write > 0 || !node.step || !prediction_[task.node].will_run || !settings_.cache || node.is_uncacheable)
            return {};
        const PlannedStep& step = *graph_.step(node);
        return work_key(step, node.code, step.parameters, inputs_of(node));
    }

    bool is_being_computed(const Task& task) const {
        if (busy_ == 0) return false;
        const std::string key = computation_key(task);
        return !key.empty() && std::ranges::find(states_, key, &WorkerState::computation) != states_.end();
    }

    void begin(std::size_t worker, const Task& task) {
        WorkerState& state = states_[worker];
        state.task = task;
        state.computation = computation_key(task);
        ++busy_;
        for (const Source& source : sources(task)) state.holds.insert(source.node);
        if (task.write == 0) {
            nodes_[task.node].state = State::running;
            notify(&RunObserver::node_started, graph_.nodes[task.node], worker);
        } else {
            const Write& write = writes_[task.write - 1];
            const RunCell& cell = graph_.cells[write.cells.front()];
            notify(&RunObserver::output_started, cell, *std::ranges::find(cell.outputs, write.file, &RunOutput::file),
                   worker);
        }
        workers_.start(worker, job(task, worker));
    }

    // Jobs: all that a worker needs for a task.

    u64 memory_limit() const { return smaller_limit(settings_.limits.cell_memory, settings_.limits.step_memory); }

    /// Sets the time left of the cell that has the most, or the limit of a step if that is smaller.
    void limit_time(const Task& task, Job& job) const {
        const Limits& limits = settings_.limits;
        job.seconds_limit = limits.step_seconds;
        job.limit_text = fmt::format("the limit of a step is {}", duration_text(limits.step_seconds));
        if (limits.cell_seconds <= 0) return;
        double left = 0.001;
        for (const std::size_t cell : cells_of(task))
            if (!cells_[cell].is_out_of_time) left = std::max(left, limits.cell_seconds - report_.cells[cell].seconds);
        if (limits.step_seconds > 0 && limits.step_seconds <= left) return;
        job.seconds_limit = left;
        job.limit_text = fmt::format("the limit of a cell is {}, of which {:.3f} s were used before",
                                     duration_text(limits.cell_seconds), limits.cell_seconds - left);
    }

    JobInput input_from(const Source& source, const std::string& port) const {
        JobInput input{port, source.node, source.port, {}, {}};
        const RunNode& node = graph_.nodes[source.node];
        if (!node.step) input.leaf = node.leaf;
        if (const std::optional<StepResult>& cached = prediction_[source.node].cached)
            if (const ResultOutput* output = cached->output(source.port)) input.content = output->content;
        return input;
    }

    std::vector<JobInput> inputs_of(const RunNode& node) const {
        std::vector<JobInput> inputs;
        for (const NodeInput& input : node.inputs) inputs.push_back(input_from({input.node, input.from}, input.port));
        return inputs;
    }

    JobCaching caching_of(std::size_t index, std::size_t worker) const {
        const RunNode& node = graph_.nodes[index];
        const NodeState& state = nodes_[index];
        JobCaching caching;
        caching.is_used = settings_.cache && !node.is_uncacheable;
        caching.plan_key = node.key;
        caching.code = node.code;
        caching.needed.assign(prediction_[index].needed.begin(), prediction_[index].needed.end());
        const bool is_taken_over = components_[state.component].owner != worker;
        caching.keep_always = settings_.shares_values && (is_taken_over || state.uses_left > 1);
        for (const NodeInput& input : node.inputs) caching.inputs_cost += nodes_[input.node].cost;
        return caching;
    }

    std::string frame_of(std::size_t index) const {
        const RunNode& node = graph_.nodes[index];
        const PlannedStep* step = graph_.step(node);
        if (!step) return fmt::format("while reading '{}'", node.leaf.file.string());
        return fmt::format("in step '{}' ({}:{}:{})", step->label,
                           step->file.empty() ? graph_.plans[node.plan]->workflow.file : step->file,
                           step->position.line, step->position.column);
    }

    Job job(const Task& task, std::size_t worker) const {
        const RunNode& node = graph_.nodes[task.node];
        const auto step = [&] {
            return std::shared_ptr<const PlannedStep>(graph_.plans[node.plan],
                                                      graph_.step(node));  // lives with its plan
        };
        Job job;
        job.node = task.node;
        job.threads = settings_.threads;
        job.seed = graph_.seed;
        job.memory_limit = memory_limit();
        limit_time(task, job);
        job.scan = graph_.scan_names[node.scan];
        if (task.write > 0) {
            const Write& write = writes_[task.write - 1];
            job.work = WriteWork{
                write.file,
                made_how(graph_, write.cells, {write.file, write.source.node, write.source.port}, report_.nodes),
                added_columns(graph_, write.source.node), must_be_closed(write.source), input_from(write.source, "")};
            job.frame = fmt::format("while writing '{}'", write.file.string());
            job.scan = graph_.scan_names[graph_.cells[write.cells.front()].scan];
            return job;
        }
        if (!node.step) {
            job.work = ReadWork{node.leaf, caching_of(task.node, worker)};
            return job;
        }
        const PlannedStep& planned = *graph_.step(node);
        job.frame = frame_of(task.node);
        if (!prediction_[task.node].will_run) {
            const std::string& primary = planned.spec.outputs.front().name;
            job.work =
                ExpectWork{step(), prediction_[task.node].cached->metrics, input_from({task.node, primary}, primary)};
            return job;
        }
        job.work = StepWork{step(), library_.build_id(planned.spec.name), inputs_of(node), node.parameter_files,
                            caching_of(task.node, worker)};
        return job;
    }

    // Ends of tasks.

    void ended(std::size_t worker, JobReport report, bool lost_values) {
        WorkerState& state = states_[worker];
        assert(state.task);
        const Task task = *state.task;
        const std::size_t component = nodes_[task.node].component;
        leave(worker);
        if (lost_values) {
            state.holds.clear();
            state.replaced_after.reset();
        } else if (!report.wear.empty()) {
            state.replaced_after = component;
            report.node.effort.log.push_back(fmt::format("scanmill: the worker is replaced: {}", report.wear));
        }
        if (report.was_read_whole)
            report.node.effort.log.push_back(
                "scanmill: the file could not be read piece by piece and was read as a whole");
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
                const std::string writing =
                    task.write > 0 ? fmt::format("writing '{}': ", writes_[task.write - 1].file.string()) : "";
                notify(&RunObserver::node_warning, graph_.nodes[task.node],
                       fmt::format("{}attempt {} of {} failed: {}", writing, failures, settings_.limits.retries + 1,
                                   report.node.failure.error.sentence()));
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
            if (prediction_[task.node].will_run && !lost_values) state.holds.insert(task.node);
            const bool is_taken_over = components_[component].owner != worker;
            finish_node(task.node, std::move(report));
            const std::set<std::string>& needed = prediction_[task.node].needed;
            // If values cannot be stored, the owner has to compute them again, so taking over steps saves nothing.
            // Streamed scans are never stored: each worker opens the file.
            if (is_taken_over && nodes_[task.node].state == State::done && !graph_.nodes[task.node].leaf.is_streamed &&
                !std::ranges::includes(nodes_[task.node].kept, needed))
                is_takeover_useless_ = true;
        }
    }

    /// Makes the worker idle.
    void leave(std::size_t worker) {
        WorkerState& state = states_[worker];
        if (state.task->write == 0) nodes_[state.task->node].state = State::pending;
        state.task.reset();
        state.computation.clear();
        --busy_;
        has_changed_ = true;
    }

    void finish_node(std::size_t index, JobReport done) {
        const RunNode& node = graph_.nodes[index];
        NodeState& state = nodes_[index];
        NodePrediction& predicted = prediction_[index];
        NodeReport& report = report_.nodes[index];
        const Task task{index};
        const std::vector<Source> used = sources(task);
        if (predicted.will_run || !only_expects(index)) {
            report = std::move(done.node);
        } else {  // only its expectations were checked
            report = {};
            scanmill::adopt(*predicted.cached, graph_.step(node), "", report);
            report.attempts = done.node.attempts;
            report.effort = std::move(done.node.effort);
            for (const std::string& warning : report.warnings) notify(&RunObserver::node_warning, node, warning);
            report.origin = Origin::cached;
            report.outcome = done.outcome;
            report.failure = std::move(done.node.failure);
            if (done.outcome == Outcome::ok) report.properties = std::move(done.node.properties);
        }
        if (predicted.will_run) {
            report.why = predicted.why;
            double cost = report.effort.seconds;
            for (const NodeInput& input : node.inputs) cost += nodes_[input.node].cost;
            if (!done.result.outputs.empty()) {
                state.kept = {done.kept.begin(), done.kept.end()};
                const bool all_kept = state.kept.size() == done.result.outputs.size();
                state.cost = all_kept ? 0 : report.origin == Origin::ran ? cost : done.result.seconds;
                predicted.cached = std::move(done.result);
            } else {
                state.cost = cost;
            }
        }
        state.state = report.outcome == Outcome::ok ? State::done : State::failed;
        notify(&RunObserver::node_ended, node, report);
        for (const Source& source : used) release(source);
        for (const Task& waiting : state.waiting) to_consider_.push_back(waiting);
        state.waiting.clear();
        if (state.uses_left == 0) {
            ++state.uses_left;
            release({index, ""});
        }
        task_ended(task);
    }

    void finish_write(const Task& task, JobReport done) {
        Write& write = writes_[task.write - 1];
        write.failure = std::move(done.node.failure);
        write.seconds = done.node.effort.seconds;
        write.report = std::move(done.output);
        write.report.file = write.file;  // the report is empty if the worker ended
        if (write.failure) write.report.outcome = Outcome::failed;
        notify(&RunObserver::output_written, graph_.cells[write.cells.front()], write.report);
        release(write.source);
        task_ended(task);
    }

    void skip(const Task& task) {
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

    /// Counts the task for its cells once, even if it runs again later.
    void task_ended(const Task& task) {
        NodeState& node = nodes_[task.node];
        Component& component = components_[node.component];
        if (--component.tasks_left == 0 && component.owner) states_[*component.owner].components.erase(node.component);
        if (task.write > 0) {
            count_for_cells(cells_of(task), writes_[task.write - 1].seconds);
        } else if (!node.is_counted) {
            node.is_counted = true;
            count_for_cells(node.cells, report_.nodes[task.node].effort.seconds);
        }
    }

    /// One task less needs the value. Workers drop it after the last.
    void release(const Source& source) {
        NodeState& node = nodes_[source.node];
        if (node.uses_left > 0) --node.uses_left;
        if (node.uses_left > 0) return;
        for (std::size_t worker = 0; worker < states_.size(); ++worker)
            if (states_[worker].holds.erase(source.node) > 0) workers_.forget(worker, source.node);
    }

    // Losses of values and workers.

    /// If a value that the task needs was lost, computes it again and lets the task wait. False if all are available.
    bool lost_input(const Task& task, std::size_t worker) {
        for (const Source& source : sources(task)) {
            if (is_available(source) || states_[worker].holds.contains(source.node)) continue;
            if (source.node == task.node && task.write == 0) {
                run_after_all(task.node);
                to_consider_.push_back(task);
                return true;
            }
            NodeState& from = nodes_[source.node];
            prediction_[source.node].needed.insert(source.port);
            if (from.state == State::done)
                compute_again(source.node, report_.nodes[source.node].origin == Origin::ran
                                               ? "its value was lost with a worker or from the cache"
                                               : "its value was removed from the cache");
            from.waiting.push_back(task);
            return true;
        }
        return false;
    }

    /// Runs a node whose cached value, needed for its expectations, was lost.
    void run_after_all(std::size_t index) {
        const std::string primary = graph_.step(graph_.nodes[index])->spec.outputs.front().name;
        release({index, primary});
        NodePrediction& predicted = prediction_[index];
        predicted.needed.insert(primary);
        predicted.will_run = true;
        predicted.why = "its value was removed from the cache";
        for (const NodeInput& input : graph_.nodes[index].inputs) ++nodes_[input.node].uses_left;
    }

    void compute_again(std::size_t index, const std::string& why) {
        NodeState& node = nodes_[index];
        assert(node.state != State::running);
        node.state = State::pending;
        node.kept.clear();
        node.failures = 0;
        node.stays_with_owner = true;
        prediction_[index].will_run = true;
        prediction_[index].why = why;
        for (const NodeInput& input : graph_.nodes[index].inputs) ++nodes_[input.node].uses_left;
        ++components_[node.component].tasks_left;
        to_consider_.push_back({index});
    }

    /// Inputs were lost after the task was assigned.
    void lost(std::size_t worker, const Task& task, const std::vector<JobInput>& inputs) {
        for (const Source& source : sources(task)) {
            const auto is_it = [&](const JobInput& input) {
                return input.node == source.node && input.from == source.port;
            };
            if (std::ranges::none_of(inputs, is_it)) continue;
            nodes_[source.node].kept.erase(source.port);
            if (states_[worker].holds.erase(source.node) > 0) workers_.forget(worker, source.node);
        }
        to_consider_.push_back(task);
    }

    /// No process can be started for this worker: others get its components.
    void start_failed(std::size_t worker) {
        WorkerState& state = states_[worker];
        const Task task = *state.task;
        leave(worker);
        state.cannot_start = true;
        state.holds.clear();
        for (const std::size_t index : state.components) {
            components_[index].owner.reset();
            if (!components_[index].ready.empty()) unowned_.insert(index);
        }
        state.components.clear();
        to_consider_.push_back(task);
    }

    /// Replaces the worker's process. Lost values are computed again when they are needed.
    void replace(std::size_t worker) {
        states_[worker].replaced_after.reset();
        states_[worker].holds.clear();
        workers_.replace(worker);
    }

    // Cells: their time and their end.

    void count_for_cells(const std::vector<std::size_t>& cells, double seconds) {
        for (const std::size_t cell : cells) {
            charge(cell, seconds);
            if (--cells_[cell].tasks_left == 0) end_cell(cell);
        }
    }

    void charge(std::size_t cell, double seconds) {
        report_.cells[cell].seconds += seconds;
        const double limit = settings_.limits.cell_seconds;
        if (limit > 0 && report_.cells[cell].seconds > limit) cells_[cell].is_out_of_time = true;
    }

    void end_cell(std::size_t index) {
        const RunCell& cell = graph_.cells[index];
        CellReport& report = report_.cells[index];
        cells_[index].has_ended = true;
        bool is_done = true;
        for (const std::size_t node : cell.nodes) {
            is_done = is_done && report_.nodes[node].outcome == Outcome::ok;
            if (!report.failure && report_.nodes[node].failure) {
                report.failure = report_.nodes[node].failure;
                report.failed_node = node;
                const std::string &own = graph_.scan_names[cell.scan],
                                  &used = graph_.scan_names[graph_.nodes[node].scan];
                if (own != used) {
                    report.failure.scan = own;
                    report.failure.equal_scan = used;
                }
            }
        }
        for (const std::size_t index_of_write : writes_of_cell_[index]) {
            const Write& write = writes_[index_of_write];
            is_done = is_done && write.report.outcome == Outcome::ok;
            if (!report.failure) report.failure = write.failure;
        }
        if (!report.failure && cells_[index].is_out_of_time && !is_done) report.failure = out_of_time(index);
        for (const std::size_t index_of_write : writes_of_cell_[index]) {
            Write& write = writes_[index_of_write];
            write.report.file = write.file;
            if (report.failure && write.report.outcome != Outcome::ok) set_aside(write.report);
            report.outputs.push_back(write.report);
        }
        report.doubts = doubts_about(cell.outputs, cell.nodes, graph_, report_.nodes);
        for (const OutputReport& output : report.outputs)
            for (const std::string& doubt : output.doubts)
                report.doubts.push_back(fmt::format("'{}': {}", output.file.string(), doubt));
        report.outcome = report.failure          ? Outcome::failed
                         : !is_done              ? Outcome::skipped
                         : report.doubts.empty() ? Outcome::ok
                                                 : Outcome::doubtful;
        notify(&RunObserver::cell_ended, cell, report);
    }

    /// A file of an earlier run must not look like this run's result, which failed.
    static void set_aside(OutputReport& output) {
        try {
            if (move_aside(output.file)) output.moved_to = previous_of(output.file);
        } catch (const Error& error) {
            output.not_moved = error.sentence();
        }
    }

    /// The failure of a cell that is out of time. Its frame names the first node or output that is not done.
    Failure out_of_time(std::size_t index) const {
        const RunCell& cell = graph_.cells[index];
        Error error("time limit exceeded: the limit of a cell is {}, {:.3f} s were used and this is not done",
                    duration_text(settings_.limits.cell_seconds), report_.cells[index].seconds);
        const auto left = std::ranges::find_if(
            cell.nodes, [&](std::size_t node) { return report_.nodes[node].outcome != Outcome::ok; });
        if (left != cell.nodes.end())
            error.add_frame(frame_of(*left));
        else
            for (const std::size_t write : writes_of_cell_[index])
                if (writes_[write].report.outcome != Outcome::ok) {
                    error.add_frame(fmt::format("while writing '{}'", writes_[write].file.string()));
                    break;
                }
        error.set_hint("raise the limit, or thin the scan first");
        return {Cause::time, 0, std::move(error), graph_.scan_names[cell.scan], {}};
    }

    /// Whether the source's step expects `closed: true` of this output.
    bool must_be_closed(const Source& source) const {
        const PlannedStep* step = graph_.step(graph_.nodes[source.node]);
        return step && step->spec.outputs.front().name == source.port &&
               std::ranges::any_of(step->expectations, [](const PlannedExpectation& expectation) {
                   return expectation.name == "closed" && expectation.low == ParameterValue(ParameterScalar(true));
               });
    }

    const std::vector<std::size_t>& cells_of(const Task& task) const {
        return task.write > 0 ? writes_[task.write - 1].cells : nodes_[task.node].cells;
    }

    void end_remaining_cells() {
        assert(is_stopped_ || std::ranges::all_of(cells_, &CellState::has_ended));
        for (std::size_t cell = 0; cell < cells_.size(); ++cell)
            if (!cells_[cell].has_ended) end_cell(cell);
    }

    FilterLibrary& library_;
    const RunGraph& graph_;
    Workers& workers_;
    const RunSettings& settings_;
    const std::vector<RunObserver*>& observers_;
    RunReport report_;
    std::vector<NodePrediction> prediction_;
    std::vector<NodeState> nodes_;
    std::vector<CellState> cells_;
    std::vector<Write> writes_;
    std::vector<std::vector<std::size_t>> writes_of_cell_;  // by the cell's outputs
    std::vector<Component> components_;
    std::set<std::size_t> unowned_;  // components without an owner that have ready tasks
    std::vector<WorkerState> states_;  // by worker
    std::deque<Task> to_consider_;
    std::size_t busy_ = 0;
    bool is_stopped_ = false;  // starts nothing new
    bool has_changed_ = true;  // since hand_out() was called
    bool is_takeover_useless_ = false;
};

}  // namespace

RunReport run(FilterLibrary& library, const RunGraph& graph, Workers& workers, const RunSettings& settings,
              const std::vector<RunObserver*>& observers) {
    return Scheduler(library, graph, workers, settings, observers).run();
}

}  // namespace scanmill
