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
    explicit TimeLeft(std::size_t workers) : workers_(workers) {}

    /// Returns the task's number, counted from 0.
    std::size_t add(std::size_t kind, std::size_t group, double size);
    /// Also of a task that has ended, or was not expected to run.
    void started(std::size_t task, double at);
    void progressed(std::size_t task, double fraction);
    /// `is_typical`: it did all of its work; others of its kind take as long.
    void ended(std::size_t task, double at, bool is_typical);
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

    std::size_t workers_, groups_ = 0;
    std::vector<Task> tasks_;
    std::vector<Kind> kinds_;
};

}  // namespace scanmill::runner
