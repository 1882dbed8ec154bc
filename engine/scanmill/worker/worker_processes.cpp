// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/worker_processes.hpp"

#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>
#include <algorithm>
#include <csignal>
#include <cstring>

#include "scanmill/base/error.hpp"
#include "scanmill/base/hash.hpp"
#include "scanmill/plugin/module.hpp"
#include "scanmill/worker/resources.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

namespace {

constexpr std::chrono::milliseconds between_looks(100);

const PlannedStep* step_of(const Job& job) {
    if (const auto* run = std::get_if<StepWork>(&job.work)) return run->step.get();
    if (const auto* expect = std::get_if<ExpectWork>(&job.work)) return expect->step.get();
    return nullptr;
}

}  // namespace

WorkerProcesses::WorkerProcesses(WorkerProcessSettings settings) : settings_(std::move(settings)) {
    resize(settings_.count);
    start_ = {settings_.cache_folder, settings_.keep_policy, ::getpid(), content_hash(core_library_file()), {}};
}

void WorkerProcesses::resize(std::size_t count) {
    places_.resize(count);
    // A process takes three descriptors here.
    rlimit files{};
    const rlim_t wanted = 3 * count + 256;
    if (::getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur < wanted) {
        files.rlim_cur = std::min<rlim_t>(wanted, files.rlim_max);
        ::setrlimit(RLIMIT_NOFILE, &files);
    }
}

void WorkerProcesses::ensure(std::size_t worker) {
    Place& place = places_[worker];
    if (place.process) return;
    start_.scratch = scratch_.folder(std::to_string(worker)).string();
    place.is_ready = place.is_silenced = false;
    place.forgotten.clear();
    place.process = std::make_unique<WorkerProcess>(settings_.command);
    place.process->send(to_message(start_));
}

void WorkerProcesses::start(std::size_t worker, Job job) {
    Place& place = places_[worker];
    place.begun = place.looked_at = Clock::now();
    place.peak_memory = 0;
    try {
        ensure(worker);
    } catch (const Error& error) {
        place.is_gone = true;
        start_failure_ = error;
        place.job = std::move(job);
        return;
    }
    place.process->read_log();
    place.process->clear_log();
    place.process->send(to_message(job, place.forgotten));  // its end is noticed when it is waited for
    place.forgotten.clear();
    place.job = std::move(job);
}

void WorkerProcesses::forget(std::size_t worker, std::size_t node) {
    Place& place = places_[worker];
    if (!place.process) return;
    place.forgotten.push_back(node);
    if (place.job) return;  // it does not listen; the next job will tell it
    place.process->send(to_message(place.forgotten));
    place.forgotten.clear();
}

void WorkerProcesses::replace(std::size_t worker) { places_[worker].process.reset(); }

void WorkerProcesses::dismiss() {
    for (const Place& place : places_)
        if (place.process) place.process->signal(SIGKILL);
}

bool WorkerProcesses::has_room(u64 memory_limit) const {
    if (memory_limit == 0) return true;
    u64 promised = 0;
    for (const Place& place : places_)
        if (place.job && place.process) {
            const u64 used = place.process->memory().anonymous;
            promised += place.job->memory_limit - std::min(used, place.job->memory_limit);
        }
    return available_memory() >= promised + memory_limit;
}

void WorkerProcesses::wait(const WorkerListener& listener, std::chrono::milliseconds patience) {
    std::vector<pollfd> watched;
    for (const Place& place : places_) {
        const WorkerProcess* process = place.process.get();
        for (const int descriptor : {process ? process->channel() : -1, process ? process->log_pipe() : -1,
                                     process ? process->descriptor() : -1})
            watched.push_back({descriptor, POLLIN, 0});
    }
    for (std::size_t worker = 0; worker < places_.size(); ++worker)
        if (places_[worker].is_gone && places_[worker].job) return report_gone(worker, listener);
    const auto milliseconds = std::chrono::ceil<std::chrono::milliseconds>(until_next_look(patience)).count();
    ::poll(watched.data(), watched.size(), static_cast<int>(std::max<std::int64_t>(milliseconds, 0)));
    for (std::size_t worker = 0; worker < places_.size(); ++worker)
        if (places_[worker].process) look_at(worker, listener);
}

WorkerProcesses::Clock::duration WorkerProcesses::until_next_look(std::chrono::milliseconds patience) const {
    Clock::duration least = patience;
    const auto now = Clock::now();
    for (const Place& place : places_) {
        if (!place.job) continue;
        least = std::min<Clock::duration>(least, between_looks);
        if (place.job->seconds_limit > 0) {
            const std::chrono::duration<double> left =
                std::chrono::duration<double>(place.job->seconds_limit) - (now - place.begun);
            if (left < least) least = std::chrono::duration_cast<Clock::duration>(left);
        }
    }
    return std::max(least, Clock::duration::zero());
}

void WorkerProcesses::look_at(std::size_t worker, const WorkerListener& listener) {
    Place& place = places_[worker];
    place.process->read_log();
    pollfd ended{place.process->descriptor(), POLLIN, 0};
    const bool has_ended = ::poll(&ended, 1, 0) > 0;  // asked first: what it said before is read all the same
    take_messages(worker, listener);
    if (!place.process) return;
    if (has_ended)
        end_of_process(worker, listener);
    else if (place.job)
        enforce_limits(worker, listener);
}

void WorkerProcesses::take_messages(std::size_t worker, const WorkerListener& listener) {
    Place& place = places_[worker];
    MessageReader& reader = place.process->reader();
    try {
        // Not without end, as with the log.
        for (int blocks = 0; blocks < 64; ++blocks) {
            const MessageReader::Arrival arrival = reader.receive(false);
            while (const std::optional<std::string> bytes = reader.next()) {
                WorkerMessage message = worker_message_from(*bytes, place.job ? step_of(*place.job) : nullptr);
                if (message.is_ready && !place.is_ready) {
                    place.is_ready = true;
                    place.begun = Clock::now();
                }
                if (message.progress) listener.on_progress(worker, *message.progress);
                if (message.warning) listener.on_warning(worker, *message.warning);
                if (message.note && std::ranges::find(notes_, *message.note) == notes_.end()) {
                    notes_.push_back(*message.note);
                    if (settings_.on_note) settings_.on_note(*message.note);
                }
                if (message.report && place.job) return take_report(worker, listener, std::move(*message.report));
            }
            if (arrival == MessageReader::Arrival::something) continue;
            // A filter may have closed the channel: nothing will be heard from this process any longer.
            if (arrival == MessageReader::Arrival::end) {
                place.is_silenced = true;
                place.process->signal(SIGKILL);
            }
            return;
        }
    } catch (const Error& error) {
        end_by_force(worker, listener, Cause::exit, error, 0);
    }
}

void WorkerProcesses::enforce_limits(std::size_t worker, const WorkerListener& listener) {
    Place& place = places_[worker];
    const Job& job = *place.job;
    const auto now = Clock::now();
    constexpr std::chrono::milliseconds grace(1200);
    if (cancelled_ && now - *cancelled_ > grace) {
        place.process.reset();
        return report_end(worker, listener, {}, true);
    }
    if (job.seconds_limit > 0 && place.is_ready &&
        now - place.begun >= std::chrono::duration<double>(job.seconds_limit))
        return end_by_force(worker, listener, Cause::time,
                            Error("the time did not suffice: it was ended after {:.3f} s, {}",
                                  std::chrono::duration<double>(now - place.begun).count(), job.limit_text)
                                .hint("raise the limit, or thin the scan first"),
                            0);
    if (now - place.looked_at < between_looks) return;
    place.looked_at = now;
    const ResidentMemory memory = place.process->memory();
    place.peak_memory = std::max(place.peak_memory, memory.peak);
    if (job.memory_limit > 0 && memory.anonymous > job.memory_limit)
        end_by_force(worker, listener, Cause::memory,
                     Error("the memory did not suffice: it was ended at {}, the limit is {}",
                           byte_size_text(memory.anonymous), byte_size_text(job.memory_limit))
                         .hint("raise the limit, or thin the scan first"),
                     0);
}

void WorkerProcesses::cancel() {
    if (cancelled_) return;
    cancelled_ = Clock::now();
    for (const Place& place : places_)
        if (place.job) place.process->signal(SIGTERM);
}

// How jobs end: with a report, by a limit, or with their process; and what is told of it.

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
    report_end(worker, listener, std::move(report), is_spoilt);
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
    report_end(worker, listener, std::move(report), true);
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
    report_end(worker, listener, std::move(report), true);
}

void WorkerProcesses::report_gone(std::size_t worker, const WorkerListener& listener) {
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
    report_end(worker, listener, std::move(report), true);
}

u64 WorkerProcesses::peak_of(const Place& place, const ProcessEnd& end) const {
    // The system's number begins with what this process had when it started the other.
    const u64 ours = resident_memory(::getpid()).peak;
    return std::max(place.peak_memory, end.peak_memory > ours || place.peak_memory == 0 ? end.peak_memory : 0);
}

void WorkerProcesses::report_end(std::size_t worker, const WorkerListener& listener, JobReport report,
                                 bool lost_values) {
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
