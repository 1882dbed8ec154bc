// SPDX-License-Identifier: GPL-3.0-or-later
// How jobs end: with a report, by a limit, or with their process; and what is told of it.
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>

#include "scanmill/engine/byte_size.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/work/worker_processes.hpp"

namespace scanmill {

namespace {

/// What a process wrote last, as a part of a sentence; nothing when it was silent.
std::string last_words(const std::vector<std::string>& log) {
    return log.empty() ? "" : fmt::format("; it wrote last: {}", log.back());
}

Error error_of(const ProcessEnd& end, u64 peak_memory, const std::vector<std::string>& log) {
    if (end.signal == 0)
        return Error("the worker process was ended from inside, with exit code {}, before the work came to its end{}",
                     end.exit_code, last_words(log));
    const char* meaning = ::sigdescr_np(end.signal);
    const char* name = ::sigabbrev_np(end.signal);
    Error error("the worker process was ended by the signal {} ({}), with {} of memory at most{}",
                name ? fmt::format("SIG{}", name) : std::to_string(end.signal), meaning ? meaning : "unknown",
                byte_size_text(peak_memory), last_words(log));
    if (end.signal == SIGKILL)
        error.set_hint(
            "the system does that when memory runs out for everybody; `limits: {memory: …}` comes before it");
    return error;
}

}  // namespace

void WorkerProcesses::take_report(std::size_t worker, const WorkerListener& listener, JobReport report) {
    Place& place = places_[worker];
    const bool gave_up = report.outcome == Outcome::skipped && report.lost.empty() && !cancelled_;
    if (gave_up)  // somebody else asked it to end
        return end_by_force(worker, listener, Cause::signal, Error("the worker process was asked to end, by SIGTERM"),
                            SIGTERM);
    // What ran out of memory, or threw what it should not, may have left anything behind.
    const Cause cause = report.node.failure.cause;
    const bool is_spoilt = cause == Cause::memory || cause == Cause::exception;
    if (is_spoilt) {
        place.process->read_log();
        report.node.effort.log = place.process->log();
        place.process.reset();
    }
    tell_end(worker, listener, std::move(report), is_spoilt);
}

void WorkerProcesses::end_of_process(std::size_t worker, const WorkerListener& listener) {
    Place& place = places_[worker];
    const ProcessEnd end = place.process->end(false);
    if (!place.job) return place.process.reset();
    JobReport report;
    report.node.effort.peak_memory = peak_of(place, end);
    if (!cancelled_) {
        const Error error = place.is_silenced && end.signal == SIGKILL
                                ? Error("the worker process closed the channel to its runner and was ended")
                                : error_of(end, report.node.effort.peak_memory, place.process->log());
        report.outcome = Outcome::failed;
        report.node.failure = failure_of(*place.job, end.signal ? Cause::signal : Cause::exit, error,
                                         end.signal ? end.signal : end.exit_code);
    }
    tell_end(worker, listener, std::move(report), true);
}

void WorkerProcesses::end_by_force(std::size_t worker, const WorkerListener& listener, Cause cause, Error error,
                                   int number) {
    Place& place = places_[worker];
    const ProcessEnd end = place.process->end(true);
    if (!place.job) return place.process.reset();
    JobReport report;
    report.outcome = Outcome::failed;
    report.node.failure = failure_of(*place.job, cause, std::move(error), number);
    report.node.effort.peak_memory = peak_of(place, end);
    tell_end(worker, listener, std::move(report), true);
}

void WorkerProcesses::tell_gone(std::size_t worker, const WorkerListener& listener) {
    Place& place = places_[worker];
    const bool others_live = std::ranges::any_of(places_, [](const Place& each) { return !each.is_gone; });
    if (others_live) {
        place.job.reset();
        return listener.on_gone(worker);
    }
    JobReport report;
    report.outcome = Outcome::failed;
    report.node.failure = failure_of(*place.job, Cause::exit, *start_failure_);
    place.is_gone = false;  // perhaps there is room for one the next time
    tell_end(worker, listener, std::move(report), true);
}

u64 WorkerProcesses::peak_of(const Place& place, const ProcessEnd& end) const {
    // The system's number begins with what this process had when it started the other.
    const u64 ours = resident_memory(::getpid()).peak;
    return std::max(place.peak_memory, end.peak_memory > ours || place.peak_memory == 0 ? end.peak_memory : 0);
}

void WorkerProcesses::tell_end(std::size_t worker, const WorkerListener& listener, JobReport report, bool lost_values) {
    Place& place = places_[worker];
    if (place.process) {
        place.process->read_log();
        report.node.effort.log = place.process->log();
        if (lost_values) place.process.reset();
    }
    if (report.node.effort.seconds == 0)
        report.node.effort.seconds = std::chrono::duration<double>(Clock::now() - place.begun).count();
    report.node.effort.threads = place.job->threads;
    report.node.outcome = report.outcome;
    place.job.reset();
    listener.on_end(worker, std::move(report), lost_values);
}

}  // namespace scanmill
