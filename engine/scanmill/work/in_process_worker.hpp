// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// One worker in this process: nothing to start and nothing to send, and a filter that crashes takes everything along.

#include <optional>

#include "scanmill/work/scratch_folder.hpp"
#include "scanmill/work/workbench.hpp"
#include "scanmill/work/workers.hpp"

namespace scanmill {

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
