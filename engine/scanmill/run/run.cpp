// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/run/run.hpp"

#include <algorithm>
#include <cassert>
#include <deque>
#include <map>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/graph/output_files.hpp"
#include "scanmill/run/cells.hpp"
#include "scanmill/worker/file_description.hpp"

namespace scanmill {

namespace {

/// The smaller of two limits, of which 0 means no limit.
template <class Number>
Number smaller_limit(Number a, Number b) {
    return a > 0 && b > 0 ? std::min(a, b) : std::max(a, b);
}

/// Decides in which order nodes run and outputs are written, for any number of workers.
///
/// An idle worker takes the first task, in the order of the graph, that can start. Therefore scans are completed one
/// after the other, and few values exist at a time. A value is removed after the last task that takes it. A value that
/// another process removed from the cache is computed again.
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
          cells_(
              graph, settings.limits, report_,
              [&](std::size_t cell) { notify(&RunObserver::cell_ended, graph_.cells[cell], report_.cells[cell]); },
              [&](std::size_t node, const std::string& text) {
                  notify(&RunObserver::node_warning, graph_.nodes[node], text);
              }),
          nodes_(graph.nodes.size()),
          running_(workers.size()) {
        report_.nodes.resize(graph.nodes.size());
        for (std::size_t worker = workers.size(); worker-- > 0;) idle_.push_back(worker);
    }

    RunReport run() {
        queue_all();
        constexpr std::chrono::milliseconds patience(100);
        const WorkerListener listener{
            [&](std::size_t worker, double fraction) {
                notify(&RunObserver::node_progress, graph_.nodes[running_[worker].task.node], fraction);
            },
            [&](std::size_t worker, std::string_view text) {
                notify(&RunObserver::node_warning, graph_.nodes[running_[worker].task.node], text);
            },
            [&](std::size_t worker, JobReport report) { ended(worker, std::move(report)); }};
        for (;;) {
            if (!report_.interrupted && settings_.is_cancelled && settings_.is_cancelled()) {
                report_.interrupted = is_stopped_ = true;
                workers_.cancel();
            }
            hand_out();
            if (busy_ == 0) break;
            workers_.wait(listener, patience);
            notify(&RunObserver::time_passed);
        }
        assert(is_stopped_ || ready_.empty());
        cells_.end_remaining();
        return std::move(report_);
    }

private:
    /// Runs a node, or writes one of its outputs. Tasks are sorted in the order of the nodes; a write follows its node.
    struct Task {
        std::size_t node = 0;
        std::size_t write = 0;  ///< 0: run the node; otherwise 1 + index into Cells::files()
        auto operator<=>(const Task&) const = default;
    };
    enum class State {
        pending,
        running,
        done,
        unmet,  ///< failed by an expectation: its outputs are drawn and written, but no other step takes them
        failed,
        skipped
    };
    struct NodeState {
        State state = State::pending;
        bool is_counted = false;  ///< Cells::task_ended() was called for the node
        unsigned failures = 0;  ///< number of attempts that ended by a crash or a limit
        double cost = 0;  ///< seconds to compute the node's values again; 0 if the cache has them
        std::set<std::string> kept;  ///< output ports whose values the cache has
        std::map<std::string, std::size_t> uses;  ///< number of unfinished tasks that take the value, by output port
        std::vector<Task> waiting;  ///< tasks that wait for the end of the node
    };
    struct Running {
        Task task;
        std::string computation;  ///< computation_key() of the task
    };

    template <class... Parameters, class... Arguments>
    void notify(void (RunObserver::*event)(Parameters...), const Arguments&... arguments) const {
        for (RunObserver* observer : observers_) (observer->*event)(arguments...);
    }

    FileToWrite& file_of(const Task& task) { return cells_.files()[task.write - 1]; }
    const FileToWrite& file_of(const Task& task) const { return cells_.files()[task.write - 1]; }
    const std::vector<std::size_t>& cells_of(const Task& task) const {
        return task.write > 0 ? file_of(task).cells : cells_.of_node(task.node);
    }

    // Values that tasks take, and readiness of tasks.

    void queue_all() {
        for (std::size_t node = 0; node < nodes_.size(); ++node) {
            if (!prediction_[node].will_run) nodes_[node].kept = prediction_[node].needed;
            to_consider_.push_back({node});
        }
        for (std::size_t write = 1; write <= cells_.files().size(); ++write)
            to_consider_.push_back({file_of({0, write}).source.first, write});
        std::ranges::sort(to_consider_);
        for (const Task& task : to_consider_) count_uses(task);
    }

    /// Whether the node's result is in the cache and only the step's expectations have to be checked.
    bool only_expects(std::size_t node) const {
        const PlannedStep* step = graph_.step(graph_.nodes[node]);
        return !prediction_[node].will_run && step && !step->expectations.empty();
    }

    /// The values that the task takes.
    std::vector<ValueSlot> sources(const Task& task) const {
        if (task.write > 0) return {file_of(task).source};
        std::vector<ValueSlot> all;
        const RunNode& node = graph_.nodes[task.node];
        if (prediction_[task.node].will_run)
            for (const NodeInput& input : node.inputs) all.emplace_back(input.node, input.from);
        else if (only_expects(task.node))
            all.emplace_back(task.node, graph_.step(node)->spec.outputs.front().name);
        return all;
    }

    void count_uses(const Task& task) {
        for (const auto& [node, port] : sources(task)) ++nodes_[node].uses[port];
    }

    /// Counts that a task no longer takes these values. Removes a value that no unfinished task takes.
    void release(const std::vector<ValueSlot>& values) {
        for (const ValueSlot& value : values)
            if (--nodes_[value.first].uses[value.second] == 0) workers_.values().remove(value);
    }

    void consider_all() {
        while (!to_consider_.empty() && !is_stopped_) {
            const Task task = to_consider_.front();
            to_consider_.pop_front();
            consider(task);
        }
    }

    /// Whether the task must not start: its cells are out of time, or a task failed and RunSettings::fail_fast is set.
    /// Outputs that show why a cell failed are drawn and written even then.
    bool is_dropped(const Task& task) const {
        if (!cells_.have_time(cells_of(task))) return true;
        return has_failed_ && !(takes_unmet(task) && cells_.are_unmet(cells_of(task)));
    }

    /// Whether the task takes values that are not as expected: it writes or draws them, which shows why the cell
    /// failed.
    bool takes_unmet(const Task& task) const {
        const PlannedStep* step = graph_.step(graph_.nodes[task.node]);
        return task.write > 0 || (step && step->spec.draws);
    }

    /// Makes the task ready, lets it wait for a node, or skips it.
    void consider(const Task& task) {
        if (is_dropped(task)) return skip(task);
        // Inputs must be done even if the result is in the cache.
        std::vector<std::size_t> prerequisites;
        if (task.write > 0)
            prerequisites.push_back(task.node);
        else
            for (const NodeInput& input : graph_.nodes[task.node].inputs) prerequisites.push_back(input.node);
        for (const std::size_t index : prerequisites) {
            NodeState& from = nodes_[index];
            if (from.state == State::unmet && takes_unmet(task)) continue;
            if (from.state >= State::unmet) return skip(task);
            if (from.state != State::done) {
                from.waiting.push_back(task);
                return;
            }
        }
        if (task.write == 0 && !prediction_[task.node].will_run && !only_expects(task.node)) return adopt(task.node);
        ready_.insert(task);
    }

    void adopt(std::size_t index) {
        const RunNode& node = graph_.nodes[index];
        JobReport done;
        done.node.origin = Origin::cached;
        done.node.outcome = Outcome::ok;
        scanmill::adopt(*prediction_[index].cached, graph_.step(node), done.node);
        if (!node.step) done.node.warnings = warnings_about(node.leaf.name(), std::move(done.node.warnings));
        for (const std::string& warning : done.node.warnings) notify(&RunObserver::node_warning, node, warning);
        finish_node(index, std::move(done));
    }

    // Giving ready tasks to idle workers.

    void hand_out() {
        consider_all();
        while (!is_stopped_ && !ready_.empty() && !idle_.empty()) {
            if (busy_ > 0 && !workers_.has_room(memory_limit())) return;
            const std::optional<Task> task = next_task();
            if (!task) return;
            begin(*task);
        }
    }

    /// Removes the first task that can start from ready_ and returns it; empty if no task can start.
    std::optional<Task> next_task() {
        for (auto next = ready_.begin(); next != ready_.end();) {
            const Task task = *next;
            if (is_being_computed(task)) {
                ++next;
                continue;
            }
            ready_.erase(next);
            if (is_dropped(task))
                skip(task);
            else if (!waits_for_lost(task))
                return task;
            consider_all();
            next = ready_.begin();
        }
        return std::nullopt;
    }

    /// Tasks with equal keys give equal results. While one of them runs, the others wait; then they take its result
    /// from the cache. Empty for tasks that do not share results.
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
        return !key.empty() && std::ranges::find(running_, key, &Running::computation) != running_.end();
    }

    void begin(const Task& task) {
        const std::size_t worker = idle_.back();
        idle_.pop_back();
        if (task.write > 0) choose_folder(file_of(task));
        if (!workers_.start(worker, job(task))) {
            ready_.insert(task);  // another worker will take it
            return;
        }
        running_[worker] = {task, computation_key(task)};
        ++busy_;
        if (task.write == 0) {
            nodes_[task.node].state = State::running;
            notify(&RunObserver::node_started, graph_.nodes[task.node], worker);
        } else {
            const FileToWrite& file = file_of(task);
            const RunCell& cell = graph_.cells[file.cells.front()];
            notify(&RunObserver::output_started, cell, *std::ranges::find(cell.outputs, file.file, &RunOutput::file),
                   worker);
        }
    }

    /// Decides whether the file is written to failed_folder(). If a cell fails later, Cells moves the file.
    void choose_folder(FileToWrite& file) const {
        file.evidence.clear();
        if (cells_.are_unmet(file.cells)) file.evidence = failed_of(graph_.output_folder, file.file);
    }

    // Making the job that tells a worker how to do a task.

    u64 memory_limit() const { return smaller_limit(settings_.limits.cell_memory, settings_.limits.step_memory); }

    JobInput input_from(const ValueSlot& source, const std::string& port) const {
        JobInput input{port, source.first, source.second, {}, {}};
        const RunNode& node = graph_.nodes[source.first];
        if (!node.step) input.leaf = node.leaf;
        if (const std::optional<StepResult>& cached = prediction_[source.first].cached)
            if (const ResultOutput* output = cached->output(source.second)) input.content = output->content;
        return input;
    }

    std::vector<JobInput> inputs_of(const RunNode& node) const {
        std::vector<JobInput> inputs;
        for (const NodeInput& input : node.inputs) inputs.push_back(input_from({input.node, input.from}, input.port));
        return inputs;
    }

    JobCaching caching_of(std::size_t index) const {
        const RunNode& node = graph_.nodes[index];
        JobCaching caching;
        caching.is_used = settings_.cache && !node.is_uncacheable;
        caching.plan_key = node.key;
        caching.code = node.code;
        caching.workflow = workflow_name(*graph_.plans[node.plan]);
        for (const auto& [port, uses] : nodes_[index].uses)
            if (uses > 0) caching.needed.push_back(port);
        for (const NodeInput& input : node.inputs) caching.inputs_cost += nodes_[input.node].cost;
        return caching;
    }

    WriteWork writing(const FileToWrite& file) const {
        const auto& [node, port] = file.source;
        WriteWork work;
        const bool is_evidence = !file.evidence.empty();
        work.file = is_evidence ? file.evidence : file.file;
        work.made_how = made_how(graph_, file.cells, {file.file, node, port}, report_.nodes, is_evidence);
        work.added_columns = added_columns(graph_, node);
        work.value = input_from(file.source, "");
        const PlannedStep* step = graph_.step(graph_.nodes[node]);
        if (!step || step->expectations.empty() || step->spec.outputs.front().name != port) return work;
        work.properties = report_.nodes[node].properties;
        work.must_be_closed =
            !is_evidence && std::ranges::any_of(step->expectations, [](const PlannedExpectation& expectation) {
                return expectation.name == "closed" && expectation.low == ParameterValue(ParameterScalar(true));
            });
        return work;
    }

    Job job(const Task& task) const {
        const RunNode& node = graph_.nodes[task.node];
        Job job;
        job.node = task.node;
        job.threads = settings_.threads;
        job.seed = graph_.seed;
        job.memory_limit = memory_limit();
        cells_.limit_time(cells_of(task), job);
        job.scan = graph_.scan_names[node.scan];
        if (task.write > 0) {
            const FileToWrite& file = file_of(task);
            job.work = writing(file);
            job.frame = fmt::format("while writing '{}'", file.file.string());
            job.scan = graph_.scan_names[graph_.cells[file.cells.front()].scan];
            return job;
        }
        if (!node.step) {
            job.work = ReadWork{node.leaf, caching_of(task.node)};
            return job;
        }
        job.frame = frame_of(graph_, task.node);
        const std::shared_ptr<const PlannedStep> step(graph_.plans[node.plan],
                                                      graph_.step(node));  // shares ownership of the plan
        if (only_expects(task.node))
            job.work = ExpectWork{step, prediction_[task.node].cached->metrics, input_from(sources(task).front(), "")};
        else
            job.work = StepWork{step, library_.build_id(step->spec.name), inputs_of(node), node.parameter_files,
                                caching_of(task.node)};
        return job;
    }

    // Ends of tasks.

    void ended(std::size_t worker, JobReport report) {
        const Task task = running_[worker].task;
        running_[worker] = {};
        idle_.push_back(worker);
        --busy_;
        if (task.write == 0) nodes_[task.node].state = State::pending;
        if (report.was_read_whole)
            report.node.effort.log.push_back("scanmill: the file could not be streamed and was loaded whole");
        if (!report.lost.empty()) return lost(task, report.lost);
        if (report.outcome == Outcome::skipped) {  // the job was cancelled
            report_.interrupted = is_stopped_ = true;
            return;
        }
        unsigned& failures = task.write > 0 ? file_of(task).failures : nodes_[task.node].failures;
        const Cause cause = report.node.failure.cause;
        const bool was_ended =
            cause == Cause::signal || cause == Cause::exit || cause == Cause::memory || cause == Cause::time;
        if (was_ended && ++failures <= settings_.limits.retries) {
            const std::string writing =
                task.write > 0 ? fmt::format("writing '{}': ", file_of(task).file.string()) : "";
            notify(&RunObserver::node_warning, graph_.nodes[task.node],
                   fmt::format("{}attempt {} of {} failed: {}", writing, failures, settings_.limits.retries + 1,
                               report.node.failure.error.sentence()));
            cells_.charge(cells_of(task), report.node.effort.seconds);
            to_consider_.push_back(task);
            return;
        }
        report.node.attempts = failures + !was_ended;
        if (report.outcome == Outcome::failed && settings_.fail_fast) has_failed_ = true;
        if (task.write > 0)
            finish_write(task, std::move(report));
        else
            finish_node(task.node, std::move(report));
    }

    void finish_node(std::size_t index, JobReport done) {
        const RunNode& node = graph_.nodes[index];
        NodeState& state = nodes_[index];
        NodePrediction& predicted = prediction_[index];
        NodeReport& report = report_.nodes[index];
        const std::vector<ValueSlot> used = sources({index});
        if (predicted.will_run || !only_expects(index)) {
            report = std::move(done.node);
        } else {  // only the expectations of the step were checked
            report = {};
            scanmill::adopt(*predicted.cached, graph_.step(node), report);
            report.attempts = done.node.attempts;
            report.effort = std::move(done.node.effort);
            for (const std::string& warning : report.warnings) notify(&RunObserver::node_warning, node, warning);
            report.origin = Origin::cached;
            report.outcome = done.outcome;
            report.failure = std::move(done.node.failure);
            if (done.outcome == Outcome::ok || report.failure.cause == Cause::expectation)
                report.properties = std::move(done.node.properties);
        }
        if (predicted.will_run) {
            report.why = predicted.why;
            state.cost = report.effort.seconds;
            for (const NodeInput& input : node.inputs) state.cost += nodes_[input.node].cost;
            if (!done.result.outputs.empty()) {
                state.kept = {done.kept.begin(), done.kept.end()};
                if (state.kept.size() == done.result.outputs.size())
                    state.cost = 0;
                else if (report.origin != Origin::ran)
                    state.cost = done.result.seconds;
                predicted.cached = std::move(done.result);
            }
        }
        state.state = report.outcome == Outcome::ok                ? State::done
                      : report.failure.cause == Cause::expectation ? State::unmet
                                                                   : State::failed;
        notify(&RunObserver::node_ended, node, report);
        release(used);
        end_task({index});
    }

    void finish_write(const Task& task, JobReport done) {
        FileToWrite& file = file_of(task);
        file.failure = std::move(done.node.failure);
        file.seconds = done.node.effort.seconds;
        file.report = std::move(done.output);
        file.report.file = file.file;  // the report is empty if the worker process ended
        if (file.failure || !file.evidence.empty()) file.report.outcome = Outcome::failed;
        if (!file.evidence.empty() && file.failure) {
            cells_.warn_of_failed_folder(file.source.first, file.failure.error.sentence());
            file.failure = {};  // the cell failed by its expectation
        } else {
            file.report.evidence = file.evidence;
        }
        notify(&RunObserver::output_written, graph_.cells[file.cells.front()], file.report);
        release({file.source});
        end_task(task);
    }

    void skip(const Task& task) {
        release(sources(task));
        if (task.write == 0) {
            nodes_[task.node].state = State::skipped;
            if (!nodes_[task.node].is_counted) report_.nodes[task.node] = {};
        }
        end_task(task);
    }

    /// Queues the tasks that wait for this task. Counts the task for its cells. A node that runs again later is counted
    /// only once.
    void end_task(const Task& task) {
        if (task.write > 0) return cells_.task_ended(cells_of(task), file_of(task).seconds);
        NodeState& node = nodes_[task.node];
        to_consider_.insert(to_consider_.end(), node.waiting.begin(), node.waiting.end());
        node.waiting.clear();
        if (node.is_counted) return;
        node.is_counted = true;
        cells_.task_ended(cells_of(task), report_.nodes[task.node].effort.seconds);
    }

    // Computing values again that were removed from the cache.

    bool is_available(const ValueSlot& value) const {
        return nodes_[value.first].kept.contains(value.second) || workers_.values().contains(value) ||
               !graph_.nodes[value.first].step;  // the node reads a file, which can be read again
    }

    /// Whether the node ended with values that tasks take.
    bool has_ended(std::size_t node) const {
        return nodes_[node].state == State::done || nodes_[node].state == State::unmet;
    }

    /// If a value that the task takes was removed, queues its node to compute it again, and makes the task wait for it.
    /// Returns whether the task has to wait.
    bool waits_for_lost(const Task& task) {
        for (const ValueSlot& source : sources(task)) {
            if (is_available(source)) continue;
            const bool is_own = task == Task{source.first};
            if (is_own || has_ended(source.first)) compute_again(source.first);
            if (!is_own) to_consider_.push_back(task);
            return true;
        }
        return false;
    }

    void compute_again(std::size_t index) {
        NodeState& node = nodes_[index];
        assert(has_ended(index) || only_expects(index));
        const std::vector<ValueSlot> own = has_ended(index) ? std::vector<ValueSlot>{} : sources({index});
        node.state = State::pending;
        node.kept.clear();
        node.failures = 0;
        prediction_[index].will_run = true;
        prediction_[index].why = "its value was removed from the cache";
        count_uses({index});
        release(own);
        to_consider_.push_back({index});
    }

    void lost(const Task& task, const std::vector<ValueSlot>& values) {
        for (const ValueSlot& value : values) {
            nodes_[value.first].kept.erase(value.second);
            workers_.values().remove(value);
        }
        to_consider_.push_back(task);
    }

    FilterLibrary& library_;
    const RunGraph& graph_;
    Workers& workers_;
    const RunSettings& settings_;
    const std::vector<RunObserver*>& observers_;
    RunReport report_;
    std::vector<NodePrediction> prediction_;
    Cells cells_;
    std::vector<NodeState> nodes_;
    std::vector<Running> running_;  // by worker
    std::vector<std::size_t> idle_;  // workers; the last one is used next, because its process may have the scan open
    std::deque<Task> to_consider_;
    std::set<Task> ready_;
    std::size_t busy_ = 0;
    bool is_stopped_ = false;  // no further task starts
    bool has_failed_ = false;  // RunSettings::fail_fast is set and a task failed
};

}  // namespace

RunReport run(FilterLibrary& library, const RunGraph& graph, Workers& workers, const RunSettings& settings,
              const std::vector<RunObserver*>& observers) {
    return Scheduler(library, graph, workers, settings, observers).run();
}

}  // namespace scanmill
