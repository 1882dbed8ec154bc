// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The lines that show how far a run is: one for each worker, then one for the whole with an estimate of the time left.

#include <optional>
#include <string>
#include <vector>

namespace scanmill::runner {

class ProgressBoard {
public:
    /// `steps`: all that are to be run or taken from the cache; `to_run`: those that take time.
    ProgressBoard(std::size_t workers, std::size_t steps, std::size_t to_run)
        : workers_(workers),
          steps_(steps),
          to_run_(to_run) {}

    /// `id`: what is being done, as whoever calls tells one thing from another. Times are seconds since the run began.
    void started(std::size_t worker, const void* id, std::string what, double at) {
        workers_[worker] = {id, std::move(what), at, 0};
    }
    void progressed(const void* id, double fraction);
    void ended(const void* id);
    void step_ended(bool took_time) {
        ++ended_;
        ran_ += took_time;
    }
    void cell_failed() { ++failed_; }

    /// At most `width` columns wide and `height` lines high: workers that do nothing give way first.
    std::vector<std::string> lines(double now, std::size_t width, std::size_t height = 1000) const;
    /// Seconds until the end as far as one can tell: the steps to come take as long as those that were, one by one.
    std::optional<double> time_left(double now) const;

private:
    struct Doing {
        const void* id = nullptr;  ///< nullptr: nothing
        std::string what;
        double since = 0, fraction = 0;
    };
    std::vector<Doing> workers_;
    std::string line_of(std::size_t worker, double now, std::size_t width) const;
    std::size_t steps_, to_run_, ended_ = 0, ran_ = 0, failed_ = 0;
};

/// "0:07", "12:30", "1:02:05".
std::string clock_text(double seconds);

}  // namespace scanmill::runner
