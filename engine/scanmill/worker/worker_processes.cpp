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

constexpr std::chrono::milliseconds between_checks(100);

}  // namespace

WorkerProcesses::WorkerProcesses(WorkerProcessSettings settings) : settings_(std::move(settings)) {
    resize(settings_.count);
    const std::string values = scratch_.folder("values").string();
    values_ = RunValues(values);
    start_ = {settings_.cache_folder, settings_.keep_policy, ::getpid(), content_hash(core_library_file()), values, {}};
}

void WorkerProcesses::resize(std::size_t count) {
    slots_.resize(count);
    // Each process needs three descriptors.
    rlimit files{};
    const rlim_t wanted = 3 * count + 256;
    if (::getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur < wanted) {
        files.rlim_cur = std::min<rlim_t>(wanted, files.rlim_max);
        ::setrlimit(RLIMIT_NOFILE, &files);
    }
}

void WorkerProcesses::ensure(std::size_t worker) {
    Slot& slot = slots_[worker];
    if (slot.process) return;
    start_.scratch = scratch_.folder(std::to_string(worker)).string();
    slot.is_ready = false;
    slot.channel_closed.reset();
    slot.process = std::make_unique<WorkerProcess>(settings_.command);
    slot.process->send(to_message(start_));
}

bool WorkerProcesses::start(std::size_t worker, Job job) {
    Slot& slot = slots_[worker];
    slot.begun = slot.checked = Clock::now();
    slot.peak_memory = 0;
    slot.loading.clear();
    try {
        ensure(worker);
    } catch (const Error& error) {
        slot.cannot_start = true;
        if (std::ranges::any_of(slots_, [](const Slot& each) { return !each.cannot_start; })) return false;
        start_failure_ = error;
        slot.job = std::move(job);
        return true;  // wait() reports the failure
    }
    slot.process->read_log();
    slot.process->clear_log();
    slot.process->send(to_message(job));  // wait() notices if the process has ended
    slot.job = std::move(job);
    return true;
}

void WorkerProcesses::dismiss() {
    for (const Slot& slot : slots_)
        if (slot.process) slot.process->signal(SIGKILL);
}

bool WorkerProcesses::has_room(u64 memory_limit) const {
    if (memory_limit == 0) return true;
    u64 promised = 0;
    for (const Slot& slot : slots_)
        if (slot.job && slot.process) {
            const u64 used = slot.process->memory().anonymous;
            promised += slot.job->memory_limit - std::min(used, slot.job->memory_limit);
        }
    return available_memory() >= promised + memory_limit;
}

void WorkerProcesses::wait(const WorkerListener& listener, std::chrono::milliseconds patience) {
    std::vector<pollfd> watched;
    for (const Slot& slot : slots_) {
        const WorkerProcess* process = slot.process.get();
        const bool has_channel = process && !slot.channel_closed;  // with a closed channel, poll() would return at once
        for (const int descriptor : {has_channel ? process->channel() : -1, process ? process->log_pipe() : -1,
                                     process ? process->descriptor() : -1})
            watched.push_back({descriptor, POLLIN, 0});
    }
    for (std::size_t worker = 0; worker < slots_.size(); ++worker)
        if (slots_[worker].cannot_start && slots_[worker].job) return report_start_failure(worker, listener);
    const auto milliseconds = std::chrono::ceil<std::chrono::milliseconds>(until_next_check(patience)).count();
    ::poll(watched.data(), watched.size(), static_cast<int>(std::max<std::int64_t>(milliseconds, 0)));
    for (std::size_t worker = 0; worker < slots_.size(); ++worker)
        if (slots_[worker].process) check(worker, listener);
}

WorkerProcesses::Clock::duration WorkerProcesses::until_next_check(std::chrono::milliseconds patience) const {
    Clock::duration least = patience;
    const auto now = Clock::now();
    for (const Slot& slot : slots_) {
        if (!slot.job) continue;
        least = std::min<Clock::duration>(least, between_checks);
        if (slot.job->seconds_limit > 0) {
            const std::chrono::duration<double> left =
                std::chrono::duration<double>(slot.job->seconds_limit) - (now - slot.begun);
            if (left < least) least = std::chrono::duration_cast<Clock::duration>(left);
        }
    }
    return std::max(least, Clock::duration::zero());
}

void WorkerProcesses::check(std::size_t worker, const WorkerListener& listener) {
    Slot& slot = slots_[worker];
    slot.process->read_log();
    pollfd ended{slot.process->descriptor(), POLLIN, 0};
    const bool has_ended = ::poll(&ended, 1, 0) > 0;  // check this before reading, so that the last messages are read
    take_messages(worker, listener);
    if (!slot.process) return;
    if (has_ended) return end_of_process(worker, listener);
    // The system closes the channel of an ending process shortly before it reports the end. A process that still runs
    // after `time_to_end` has closed the channel itself and can do no more jobs.
    constexpr std::chrono::seconds time_to_end(1);
    if (slot.channel_closed && Clock::now() - *slot.channel_closed > time_to_end)
        return kill(worker, listener, Cause::signal,
                    Error("the filter closed the channel from the worker process to its runner"), SIGKILL);
    if (slot.job) enforce_limits(worker, listener);
}

void WorkerProcesses::take_messages(std::size_t worker, const WorkerListener& listener) {
    Slot& slot = slots_[worker];
    MessageReader& reader = slot.process->reader();
    try {
        // The number of blocks is limited as in read_log().
        for (int blocks = 0; blocks < 64; ++blocks) {
            const MessageReader::Arrival arrival = reader.receive(false);
            while (const std::optional<std::string> bytes = reader.next()) {
                WorkerMessage message = worker_message_from(*bytes);
                if (message.is_ready && !slot.is_ready) {
                    slot.is_ready = true;
                    slot.begun = Clock::now();
                }
                if (message.loading) slot.loading = *message.loading;
                if (message.progress && slot.job) listener.on_progress(worker, *message.progress);
                if (message.warning && slot.job) listener.on_warning(worker, *message.warning);
                if (message.note && std::ranges::find(notes_, *message.note) == notes_.end()) {
                    notes_.push_back(*message.note);
                    if (settings_.on_note) settings_.on_note(*message.note);
                }
                if (message.report && slot.job) return take_report(worker, listener, std::move(*message.report));
            }
            if (arrival == MessageReader::Arrival::something) continue;
            if (arrival == MessageReader::Arrival::end && !slot.channel_closed) slot.channel_closed = Clock::now();
            return;
        }
    } catch (const Error& error) {
        kill(worker, listener, Cause::exit, error, 0);
    }
}

void WorkerProcesses::enforce_limits(std::size_t worker, const WorkerListener& listener) {
    Slot& slot = slots_[worker];
    const Job& job = *slot.job;
    const auto now = Clock::now();
    constexpr std::chrono::milliseconds grace(1200);
    if (cancelled_ && now - *cancelled_ > grace) {
        slot.process.reset();
        return report_end(worker, listener, {}, true);
    }
    if (job.seconds_limit > 0 && slot.is_ready && now - slot.begun >= std::chrono::duration<double>(job.seconds_limit))
        return kill(worker, listener, Cause::time,
                    Error("time limit exceeded: stopped after {:.3f} s, {}",
                          std::chrono::duration<double>(now - slot.begun).count(), job.limit_text)
                        .hint("raise the limit, or thin the scan first"),
                    0);
    if (now - slot.checked < between_checks) return;
    slot.checked = now;
    const ResidentMemory memory = slot.process->memory();
    slot.peak_memory = std::max(slot.peak_memory, memory.peak);
    if (job.memory_limit > 0 && memory.anonymous > job.memory_limit)
        kill(worker, listener, Cause::memory,
             Error("memory limit exceeded: stopped at {}, the limit is {}", byte_size_text(memory.anonymous),
                   byte_size_text(job.memory_limit))
                 .hint("raise the limit, or thin the scan first"),
             0);
}

void WorkerProcesses::cancel() {
    if (cancelled_) return;
    cancelled_ = Clock::now();
    for (const Slot& slot : slots_)
        if (slot.job && slot.process) slot.process->signal(SIGTERM);
}

// A job ends by a report, by a limit, or when its process ends.

namespace {

/// The last line that a process wrote, for the end of a sentence; empty if it wrote nothing.
std::string last_line(const std::vector<std::string>& log) {
    return log.empty() ? "" : fmt::format("; its last output: {}", log.back());
}

Error error_of(const ProcessEnd& end, u64 peak_memory, const std::vector<std::string>& log) {
    if (end.signal == 0)
        return Error("the worker process exited with code {} before its work was done{}", end.exit_code,
                     last_line(log));
    const char* meaning = ::sigdescr_np(end.signal);
    const char* name = ::sigabbrev_np(end.signal);
    Error error("the worker process was ended by the signal {} ({}); its largest memory was {}{}",
                name ? fmt::format("SIG{}", name) : std::to_string(end.signal), meaning ? meaning : "unknown",
                byte_size_text(peak_memory), last_line(log));
    if (end.signal != SIGKILL) return error;
    return std::move(error)
        .hint(
            "the system may have run out of memory and ended the largest process; `limits: {memory: …}` stops a step "
            "before that happens")
        .remedy(Remedy::add_memory);
}

}  // namespace

void WorkerProcesses::take_report(std::size_t worker, const WorkerListener& listener, JobReport report) {
    const bool gave_up = report.outcome == Outcome::skipped && report.lost.empty() && !cancelled_;
    if (gave_up)
        return kill(worker, listener, Cause::signal, Error("another program sent SIGTERM to the worker process"),
                    SIGTERM);
    // After these failures the state of the process is uncertain.
    const Cause cause = report.node.failure.cause;
    const bool is_uncertain = cause == Cause::memory || cause == Cause::exception || !report.wear.empty();
    report_end(worker, listener, std::move(report), is_uncertain);
}

void WorkerProcesses::end_of_process(std::size_t worker, const WorkerListener& listener) {
    Slot& slot = slots_[worker];
    const ProcessEnd end = slot.process->end(false);
    if (!slot.job) return slot.process.reset();
    JobReport report;
    report.node.effort.peak_memory = peak_of(slot, end);
    if (!cancelled_) {
        Error error = error_of(end, report.node.effort.peak_memory, slot.process->log());
        report.outcome = Outcome::failed;
        if (!slot.loading.empty()) error.add_frame(fmt::format("while loading the module '{}'", slot.loading));
        report.node.failure = failure_of(*slot.job, end.signal ? Cause::signal : Cause::exit, error,
                                         end.signal ? end.signal : end.exit_code);
    }
    report_end(worker, listener, std::move(report), true);
}

void WorkerProcesses::kill(std::size_t worker, const WorkerListener& listener, Cause cause, Error error, int number) {
    Slot& slot = slots_[worker];
    const ProcessEnd end = slot.process->end(true);
    if (!slot.job) return slot.process.reset();
    JobReport report;
    report.outcome = Outcome::failed;
    if (!slot.loading.empty()) error.add_frame(fmt::format("while loading the module '{}'", slot.loading));
    report.node.failure = failure_of(*slot.job, cause, std::move(error), number);
    report.node.effort.peak_memory = peak_of(slot, end);
    report_end(worker, listener, std::move(report), true);
}

void WorkerProcesses::report_start_failure(std::size_t worker, const WorkerListener& listener) {
    Slot& slot = slots_[worker];
    JobReport report;
    report.outcome = Outcome::failed;
    report.node.failure = failure_of(*slot.job, Cause::exit, *start_failure_);
    slot.cannot_start = false;  // the next job tries again
    report_end(worker, listener, std::move(report), true);
}

u64 WorkerProcesses::peak_of(const Slot& slot, const ProcessEnd& end) const {
    // The peak that the system reports is at least the size that this process had when it started the worker. Therefore
    // the reported peak counts only if it is larger than the peak of this process.
    const u64 ours = resident_memory(::getpid()).peak;
    return std::max(slot.peak_memory, end.peak_memory > ours || slot.peak_memory == 0 ? end.peak_memory : 0);
}

void WorkerProcesses::report_end(std::size_t worker, const WorkerListener& listener, JobReport report,
                                 bool ends_process) {
    Slot& slot = slots_[worker];
    if (slot.process) {
        slot.process->read_log();
        report.node.effort.log = slot.process->log();
        if (ends_process) slot.process.reset();
    }
    if (!report.wear.empty())
        report.node.effort.log.push_back(fmt::format("scanmill: the worker is replaced: {}", report.wear));
    if (report.node.effort.seconds == 0)
        report.node.effort.seconds = std::chrono::duration<double>(Clock::now() - slot.begun).count();
    report.node.effort.threads = slot.job->threads;
    report.node.outcome = report.outcome;
    slot.job.reset();
    listener.on_end(worker, std::move(report));
}

}  // namespace scanmill
