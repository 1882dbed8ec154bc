// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Workers that are processes: whatever a filter does to its own, the others and this one go on.
///
/// A worker is started for its first job, used again, and replaced when it ended, had to be ended, or is asked to be.
/// A job that takes longer than its limit, or whose process has more memory than its limit, ends with its process.
/// Memory is limited twice: allocating beyond the limit fails inside the process (RLIMIT_DATA), and what is resident is
/// looked at several times a second.

#include <memory>
#include <optional>

#include "scanmill/base/error.hpp"
#include "scanmill/worker/messages.hpp"
#include "scanmill/worker/scratch_folder.hpp"
#include "scanmill/worker/worker_process.hpp"
#include "scanmill/worker/workers.hpp"

namespace scanmill {

struct WorkerProcessSettings {
    std::vector<std::string> command;  ///< the program, by its absolute path, and what makes it call serve_as_worker()
    std::size_t count = 1;
    std::string cache_folder;  ///< empty: none
    int keep_policy = 0;
    /// What a worker says of its surroundings, its cache. Equal sentences of several workers come once.
    std::function<void(std::string)> on_note;
};

class WorkerProcesses : public Workers {
public:
    using Clock = std::chrono::steady_clock;

    explicit WorkerProcesses(WorkerProcessSettings settings);

    std::size_t size() const override { return places_.size(); }
    bool has_room(u64 memory_limit) const override;
    void start(std::size_t worker, Job job) override;
    void forget(std::size_t worker, std::size_t node) override;
    void replace(std::size_t worker) override;
    void wait(const WorkerListener& listener, std::chrono::milliseconds patience) override;
    void cancel() override;
    /// Starts the first process before there is a job for it, so that it is ready by then.
    void start_early() { ensure(0); }
    /// Begins to end all processes: no more jobs are to come. Whoever lets go of this object waits for their ends.
    void dismiss();
    /// From now on there are so many. Pre: no job was begun.
    void resize(std::size_t count);

private:
    struct Place {
        std::unique_ptr<WorkerProcess> process;
        std::optional<Job> job;
        Clock::time_point begun, looked_at;
        bool is_ready = false;  ///< its process has started
        bool is_silenced = false;  ///< it was ended because it closed the channel
        bool is_gone = false;  ///< no process can be started for it
        u64 peak_memory = 0;
        std::vector<std::size_t> forgotten;  ///< told with the next job
    };

    void ensure(std::size_t worker);
    void look_at(std::size_t worker, const WorkerListener& listener);
    void take_messages(std::size_t worker, const WorkerListener& listener);
    void enforce_limits(std::size_t worker, const WorkerListener& listener);
    Clock::duration until_next_look(std::chrono::milliseconds patience) const;

    // worker_processes_ends.cpp
    void take_report(std::size_t worker, const WorkerListener& listener, JobReport report);
    void end_of_process(std::size_t worker, const WorkerListener& listener);
    void end_by_force(std::size_t worker, const WorkerListener& listener, Cause cause, Error error, int number);
    void report_gone(std::size_t worker, const WorkerListener& listener);
    u64 peak_of(const Place& place, const ProcessEnd& end) const;
    void report_end(std::size_t worker, const WorkerListener& listener, JobReport report, bool lost_values);

    WorkerProcessSettings settings_;
    WorkerStart start_;
    ScratchFolder scratch_;  // one folder in it for each worker
    std::vector<Place> places_;
    std::vector<std::string> notes_;
    std::optional<Clock::time_point> cancelled_;
    std::optional<Error> start_failure_;
};

}  // namespace scanmill
