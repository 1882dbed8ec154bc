// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The interface of workers, and the worker in this process.

#include <chrono>
#include <functional>
#include <optional>

#include "scanmill/worker/resources.hpp"
#include "scanmill/worker/workbench.hpp"

namespace scanmill {

/// Receives events of workers. All calls come from within Workers::wait(), on its thread. Only the progress and
/// warnings of InProcessWorker come from the threads of its filter, one call at a time.
struct WorkerListener {
    std::function<void(std::size_t worker, double fraction)> on_progress;
    std::function<void(std::size_t worker, std::string_view text)> on_warning;
    /// Called when a job has ended and the worker is idle again.
    std::function<void(std::size_t worker, JobReport report)> on_end;
};

/// Workers, numbered from 0. Each does one job at a time. Values pass from job to job through values() and the cache,
/// so any worker can do any job.
class Workers {
public:
    virtual ~Workers() = default;
    virtual std::size_t size() const = 0;
    /// Whether the machine has memory for one more job with this limit in bytes. The running jobs are assumed to use
    /// their limits.
    virtual bool has_room(u64 /*memory_limit*/) const { return true; }
    /// Starts a job. Returns false if this worker cannot start but others may; it must get no more jobs. Pre: the
    /// worker is idle.
    virtual bool start(std::size_t worker, Job job) = 0;
    virtual RunValues& values() = 0;
    /// Waits for events and passes them to `listener`. Returns after an event, or after `patience`. Does not throw.
    virtual void wait(const WorkerListener& listener, std::chrono::milliseconds patience) = 0;
    /// Cancels the running jobs. Within two seconds every worker reports the end of its job.
    virtual void cancel() = 0;
};

/// One worker in this process. A filter that crashes ends the process. The time limit is not enforced.
class InProcessWorker : public Workers {
public:
    InProcessWorker(FilterLibrary& library, Cache* cache, KeepRule::Policy policy, std::function<bool()> is_cancelled)
        : bench_(library, cache, policy, values_, scratch_.folder("worker")),
          is_cancelled_(std::move(is_cancelled)) {}

    std::size_t size() const override { return 1; }
    bool start(std::size_t, Job job) override {
        job_ = std::move(job);
        return true;
    }
    RunValues& values() override { return values_; }
    void wait(const WorkerListener& listener, std::chrono::milliseconds) override {
        if (!job_) return;
        const JobListener job_listener{[&](double fraction) { listener.on_progress(0, fraction); },
                                       [&](std::string_view text) { listener.on_warning(0, text); }, is_cancelled_};
        JobReport report = bench_.perform(*job_, job_listener);
        job_.reset();
        listener.on_end(0, std::move(report));
    }
    void cancel() override {}

private:
    ScratchFolder scratch_;
    RunValues values_;
    Workbench bench_;
    std::function<bool()> is_cancelled_;
    std::optional<Job> job_;
};

}  // namespace scanmill
