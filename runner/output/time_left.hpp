// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Estimates the remaining time of a run from the times that its tasks took so far.

#include <cstddef>
#include <optional>
#include <vector>

namespace scanmill::runner {

/// The time of a task is assumed proportional to its size, with one factor per kind. Tasks of one group mostly run one
/// after the other, on one worker, such as the steps of one scan. All times are seconds since the run began.
class TimeLeft {
public:
    /// The tasks run in the first pass. Every further pass is assumed to take as long as the pass before.
    explicit TimeLeft(std::size_t workers, unsigned passes = 1) : workers_(workers), passes_(passes) {}

    /// Adds a task; returns its number, counted from 0.
    std::size_t add(std::size_t kind, std::size_t group, double size);
    /// May also be called for a task that has ended, or that was not expected to run.
    void started(std::size_t task, double at);
    void progressed(std::size_t task, double fraction);
    /// `is_typical`: the task did all of its work, so its time is used for the estimate of others of its kind.
    void ended(std::size_t task, double at, bool is_typical);
    /// The second pass or a later pass begins.
    void pass_started(unsigned pass, double at);
    /// The task will not run.
    void dropped(std::size_t task) { tasks_[task].state = State::done; }

    /// The estimated seconds until the end. Empty if they are unknown. One reason is a task that reports no progress
    /// while no task of its kind has ended. The other reason is that most of the time left belongs to tasks that
    /// already take longer than others of their kind. Cost: O(tasks).
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
        double seconds = 0, size = 0;  ///< sums over the tasks that ended
    };
    struct Estimate {
        double seconds;
        bool is_guess;
    };
    std::optional<Estimate> left_of(const Task& task, double now) const;
    std::optional<double> left_of_tasks(double now) const;

    std::size_t workers_, groups_ = 0;
    unsigned passes_, pass_ = 1;
    double pass_began_ = 0, last_pass_ = 0;  ///< `pass_began_`: time; `last_pass_`: duration of the pass before
    std::vector<Task> tasks_;
    std::vector<Kind> kinds_;
};

}  // namespace scanmill::runner
