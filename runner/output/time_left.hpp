// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Estimates how long a run still takes from how long its tasks took so far.

#include <cstddef>
#include <optional>
#include <vector>

namespace scanmill::runner {

/// Tasks of one kind take time in proportion to their size. Tasks of one group mostly run one after the other, on one
/// worker, as the steps of one scan do. All times are seconds since the run began.
class TimeLeft {
public:
    /// The tasks run in the first pass. Further passes take as long as the one before.
    explicit TimeLeft(std::size_t workers, unsigned passes = 1) : workers_(workers), passes_(passes) {}

    /// Returns the task's number, counted from 0.
    std::size_t add(std::size_t kind, std::size_t group, double size);
    /// May be called for a task that has ended, or was not expected to run.
    void started(std::size_t task, double at);
    void progressed(std::size_t task, double fraction);
    /// `is_typical`: it did all of its work; others of its kind take as long.
    void ended(std::size_t task, double at, bool is_typical);
    /// The second pass or a later one begins.
    void pass_started(unsigned pass, double at);
    /// It will not run.
    void dropped(std::size_t task) { tasks_[task].state = State::done; }

    /// Nothing if it is unknown: none of a task's kind has ended and it reports no progress, or most of the time left
    /// is that of tasks that run longer than others of their kind. Cost: O(tasks).
    std::optional<double> seconds(double now) const;

private:
    enum class State { open, running, done };
    struct Task {
        std::size_t kind, group;
        double size;
        State state = State::open;
        double since = 0, fraction = 0;
    };
    struct Kind {
        double seconds = 0, size = 0;  ///< sums over tasks that ended
    };
    struct Estimate {
        double seconds;
        bool is_guess;
    };
    std::optional<Estimate> left_of(const Task& task, double now) const;
    std::optional<double> left_of_tasks(double now) const;

    std::size_t workers_, groups_ = 0;
    unsigned passes_, pass_ = 1;
    double pass_began_ = 0, last_pass_ = 0;  ///< `last_pass_`: seconds of the pass before
    std::vector<Task> tasks_;
    std::vector<Kind> kinds_;
};

}  // namespace scanmill::runner
