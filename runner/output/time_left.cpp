// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/time_left.hpp"

#include <algorithm>

namespace scanmill::runner {

std::size_t TimeLeft::add(std::size_t kind, std::size_t group, double size) {
    kinds_.resize(std::max(kinds_.size(), kind + 1));
    groups_ = std::max(groups_, group + 1);
    tasks_.push_back({kind, group, size});
    return tasks_.size() - 1;
}

void TimeLeft::started(std::size_t task, double at) {
    tasks_[task].state = State::running;
    tasks_[task].since = at;
    tasks_[task].fraction = 0;
}

void TimeLeft::progressed(std::size_t task, double fraction) { tasks_[task].fraction = fraction; }

void TimeLeft::ended(std::size_t task, double at, bool is_typical) {
    Task& done = tasks_[task];
    if (is_typical && done.state == State::running) {
        kinds_[done.kind].seconds += at - done.since;
        kinds_[done.kind].size += done.size;
    }
    done.state = State::done;
}

std::optional<TimeLeft::Estimate> TimeLeft::left_of(const Task& task, double now) const {
    const Kind& kind = kinds_[task.kind];
    const bool is_known = kind.size > 0;
    const double expected = is_known ? kind.seconds / kind.size * task.size : 0;
    if (task.state == State::open) return is_known ? std::optional(Estimate{expected, false}) : std::nullopt;
    const double elapsed = now - task.since;
    double left = expected - elapsed;
    // A filter may report 100 % while it still works.
    if (task.fraction > 0 && task.fraction < 1) left = std::max(left, elapsed * (1 - task.fraction) / task.fraction);
    if (left > 0) return Estimate{left, false};
    return is_known ? std::optional(Estimate{elapsed, true}) : std::nullopt;  // assumes as much time again
}

void TimeLeft::pass_started(unsigned pass, double at) {
    last_pass_ = at - pass_began_;
    pass_began_ = at;
    pass_ = pass;
}

std::optional<double> TimeLeft::seconds(double now) const {
    const double elapsed = now - pass_began_;
    const std::optional<double> left = pass_ == 1 ? left_of_tasks(now) : std::optional(last_pass_ - elapsed);
    if (!left || *left <= 0) return std::nullopt;
    return *left + (passes_ - pass_) * (elapsed + *left);
}

std::optional<double> TimeLeft::left_of_tasks(double now) const {
    struct Group {
        double left = 0;
        std::size_t unfinished = 0, running = 0;
    };
    std::vector<Group> groups(groups_);
    double all = 0, guessed = 0;
    std::size_t running = 0, unfinished_groups = 0;
    for (const Task& task : tasks_) {
        if (task.state == State::done) continue;
        const std::optional<Estimate> left = left_of(task, now);
        if (!left) return std::nullopt;
        Group& group = groups[task.group];
        unfinished_groups += group.unfinished++ == 0;
        group.left += left->seconds;
        all += left->seconds;
        if (left->is_guess) guessed += left->seconds;
        group.running += task.state == State::running;
        running += task.state == State::running;
    }
    if (unfinished_groups == 0) return std::nullopt;
    // An idle worker can take over groups that have not begun, and groups that several workers share already.
    double most = all / static_cast<double>(std::min(workers_, std::max(running, unfinished_groups)));
    for (const Group& group : groups)
        most = std::max(most, group.left / static_cast<double>(std::max<std::size_t>(1, group.running)));
    return guessed > most / 2 ? std::nullopt : std::optional(most);
}

}  // namespace scanmill::runner
