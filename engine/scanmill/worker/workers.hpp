// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Those who do jobs, seen from the one who hands them out.

#include <chrono>
#include <functional>
#include <optional>

#include "scanmill/worker/job.hpp"
#include "scanmill/worker/scratch_folder.hpp"
#include "scanmill/worker/workbench.hpp"

namespace scanmill {

/// What workers tell; every call comes from within Workers::wait(), but progress and warnings of a worker in this
/// process, which come from the threads of its filter, one at a time.
struct WorkerListener {
    std::function<void(std::size_t worker, double fraction)> on_progress;
    std::function<void(std::size_t worker, std::string_view text)> on_warning;
    /// The worker is idle again. With `lost_values` it is another one now, or as good as: it holds nothing.
    std::function<void(std::size_t worker, JobReport report, bool lost_values)> on_end;
    /// The worker could not begin, and is gone for good: others have to do its job.
    std::function<void(std::size_t worker)> on_gone;
};

/// Any number of workers, numbered from 0; each does one job at a time and holds the values that its jobs made or used
/// until it is told to forget them.
class Workers {
public:
    virtual ~Workers() = default;
    virtual std::size_t size() const = 0;
    /// Whether the machine has so many bytes for one more job, beside what those that are being done may need.
    virtual bool has_room(u64 /*memory_limit*/) const { return true; }
    /// Pre: the worker is idle.
    virtual void start(std::size_t worker, Job job) = 0;
    virtual void forget(std::size_t worker, std::size_t node) = 0;
    /// The worker ends, and another takes its place. Pre: it is idle and holds nothing that is needed.
    virtual void replace(std::size_t /*worker*/) {}
    /// Returns when something was told, or after the time given. Throws nothing.
    virtual void wait(const WorkerListener& listener, std::chrono::milliseconds patience) = 0;
    /// What is being done is given up: within two seconds every worker has told its end, as skipped or done.
    virtual void cancel() = 0;
};

// One worker in this process: nothing to start and nothing to send, and a filter that crashes takes everything along.

/// Limits of memory and time are not kept.
class InProcessWorker : public Workers {
public:
    InProcessWorker(FilterLibrary& library, Cache* cache, KeepRule::Policy policy, std::function<bool()> is_cancelled)
        : bench_(library, cache, policy, scratch_.folder("worker")),
          is_cancelled_(std::move(is_cancelled)) {}

    std::size_t size() const override { return 1; }
    void start(std::size_t, Job job) override { job_ = std::move(job); }
    void forget(std::size_t, std::size_t node) override { bench_.forget(node); }
    void wait(const WorkerListener& listener, std::chrono::milliseconds) override {
        if (!job_) return;
        const JobListener here{[&](double fraction) { listener.on_progress(0, fraction); },
                               [&](std::string_view text) { listener.on_warning(0, text); }, is_cancelled_};
        JobReport report = bench_.perform(*job_, here);
        job_.reset();
        listener.on_end(0, std::move(report), false);
    }
    void cancel() override {}

private:
    ScratchFolder scratch_;
    Workbench bench_;
    std::function<bool()> is_cancelled_;
    std::optional<Job> job_;
};

}  // namespace scanmill
