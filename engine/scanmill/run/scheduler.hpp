// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Who does what next: the order in which the nodes of a graph are run and its outputs written, by how many workers
/// there may be.
///
/// Nodes that depend on each other, directly or not, form a component: one scan under all its variants, as a rule. A
/// component has one home, the worker that began it, where values pass from step to step in memory; another worker
/// helps out, when it has no component of its own, with steps whose inputs the cache has. So no value has to be copied
/// as long as there are enough scans, and none is computed twice: what is lost (a worker that ended, a cache that was
/// emptied meanwhile) is made again.

#include <deque>
#include <map>
#include <set>

#include "scanmill/run/run.hpp"

namespace scanmill {

class Scheduler {
public:
    /// All must outlive it.
    Scheduler(FilterLibrary& library, const RunGraph& graph, Workers& workers, const RunSettings& settings,
              RunObserver& observer);
    RunReport run();

private:
    /// Running a node, or writing one of its outputs; nodes come in the order of the graph, writes after their node.
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
        bool is_counted = false;  ///< its cells know that it has ended once
        unsigned failures = 0;  ///< of the worker, since it was last to be made
        bool stays_home = false;  ///< it had to be made again: values of it get lost on the way
        std::size_t uses_left = 0;  ///< unfinished tasks that need its values
        std::size_t component = 0;
        double cost = 0;  ///< seconds to make its values again; 0 when the cache has them
        std::set<std::string> kept;  ///< ports whose values the cache has
        std::vector<Task> waiting;  ///< until it has ended
        std::vector<std::size_t> cells;
    };
    struct CellState {
        std::size_t tasks_left = 0;
        bool has_ended = false;
        bool is_given_up = false;  ///< its time is over
    };
    struct Component {
        std::optional<std::size_t> home;  ///< a worker
        std::set<Task> ready;
        std::size_t tasks_left = 0;
    };
    struct WorkerState {
        std::optional<Task> task;
        std::string twin;  ///< key of what it computes
        std::set<std::size_t> holds;  ///< nodes
        std::set<std::size_t> components;  ///< whose home it is
        std::optional<std::size_t> worn_by;  ///< the component after which it is not as it was
        bool is_gone = false;
    };

    void lay_out();
    std::vector<Source> sources(const Task& task) const;
    std::vector<std::size_t> prerequisites(const Task& task) const;
    bool only_expects(std::size_t node) const;
    void consider_all();
    void consider(const Task& task);
    bool is_wanted(const Task& task) const;
    void adopt(std::size_t node);

    // scheduler_hand_out.cpp
    void hand_out();
    std::optional<Task> next_for(std::size_t worker);
    std::optional<Task> next_at_home(std::size_t worker, Component& component);
    bool is_kept(const Source& source) const;
    bool is_at_hand(const Source& source) const;
    bool may_help(const Task& task) const;
    bool is_being_computed(const Task& task) const;
    std::string twin_key(const Task& task) const;
    void begin(std::size_t worker, const Task& task);

    // scheduler_jobs.cpp
    u64 memory_limit() const;
    std::string frame_of(std::size_t node) const;
    Job job(const Task& task, std::size_t worker) const;
    JobMemory memory_of(std::size_t node, std::size_t worker) const;
    JobInput input_from(const Source& source, const std::string& port) const;
    std::vector<JobInput> inputs_of(const RunNode& node) const;
    void limit_time(const Task& task, Job& job) const;

    // scheduler_ends.cpp
    void ended(std::size_t worker, JobReport report, bool lost_values);
    void leave(std::size_t worker);
    void finish_node(std::size_t node, JobReport report);
    void finish_write(const Task& task, JobReport report);
    void skip(const Task& task);
    void task_ended(const Task& task);
    void release(const Source& source);

    // scheduler_losses.cpp
    bool lost_input(const Task& task, std::size_t worker);
    void ask_no_more(std::size_t node);
    void make_again(std::size_t node, const std::string& why);
    void lost(std::size_t worker, const Task& task, const std::vector<JobInput>& inputs);
    void gone(std::size_t worker);
    void renew(std::size_t worker);

    // scheduler_cells.cpp
    const std::vector<std::size_t>& cells_of(const Task& task) const;
    void count_for_cells(const std::vector<std::size_t>& cells, double seconds);
    void charge(std::size_t cell, double seconds);
    void end_cell(std::size_t cell);
    Failure out_of_time(std::size_t cell) const;
    void skip_the_rest();

    FilterLibrary& library_;
    const RunGraph& graph_;
    Workers& workers_;
    const RunSettings& settings_;
    RunObserver& observer_;
    RunReport report_;
    std::vector<NodePrediction> prediction_;
    std::vector<NodeState> nodes_;
    std::vector<CellState> cells_;
    std::vector<Write> writes_;
    std::vector<std::vector<std::size_t>> writes_of_cell_;  // by the cell's outputs
    std::vector<Component> components_;
    std::set<std::size_t> fresh_;  // components without a home that have something ready
    std::vector<WorkerState> at_;  // by worker
    std::deque<Task> to_consider_;
    std::size_t busy_ = 0;
    bool is_stopped_ = false;  // nothing new is begun
    bool has_changed_ = true;  // since work was handed out last
    bool is_helping_useless_ = false;
};

}  // namespace scanmill
