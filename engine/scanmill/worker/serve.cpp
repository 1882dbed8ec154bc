// SPDX-License-Identifier: GPL-3.0-or-later
// The worker process receives jobs, does them with a Workbench, and sends the reports.
#include <malloc.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <memory>
#include <mutex>

#include "scanmill/base/error.hpp"
#include "scanmill/base/hash.hpp"
#include "scanmill/plugin/module.hpp"
#include "scanmill/worker/workbench.hpp"
#include "scanmill/worker/worker_processes.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

namespace {

// Set by the signal handler.
volatile std::sig_atomic_t cancel_requested = 0;

/// Sends messages to the runner, from any thread.
class Sender {
public:
    void send(const WorkerMessage& message) {
        const std::scoped_lock one_at_a_time(mutex_);
        if (!send_message(worker_channel, to_message(message))) ::_exit(1);  // the runner has ended
    }
    void send_progress(double fraction) {
        constexpr std::chrono::milliseconds pause(100);
        const auto now = std::chrono::steady_clock::now();
        if (now - last_progress_ < pause) return;
        last_progress_ = now;
        send({.progress = fraction});
    }

private:
    std::mutex mutex_;
    std::chrono::steady_clock::time_point last_progress_;
};

void prepare_process(const WorkerStart& start) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != start.parent) ::_exit(1);  // the runner ended before the call above
    std::signal(SIGTERM, [](int) { cancel_requested = 1; });
    std::signal(SIGINT, SIG_IGN);
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    // When the machine runs out of memory, the kernel kills a worker before the runner and other programs.
    std::ofstream("/proc/self/oom_score_adj") << "500";
}

u64 anonymous_memory() { return resident_memory(::getpid()).anonymous; }

std::size_t open_files() {
    std::error_code unknown;
    const std::filesystem::directory_iterator files("/proc/self/fd", unknown);
    return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

/// Describes open files or memory that the process gained since its start, for the end of a sentence. Empty if it has
/// no more files and at most 256 MiB more memory.
std::string leak(u64 memory_at_start, std::size_t files_at_start) {
    if (const std::size_t files = open_files(); files > files_at_start)
        return count_text(files - files_at_start, "more file is open", "more files are open");
    constexpr u64 tolerable = u64(256) << 20;
    if (anonymous_memory() < memory_at_start + tolerable) return {};
    ::malloc_trim(0);
    const u64 now = anonymous_memory();
    return now < memory_at_start + tolerable
               ? ""
               : fmt::format("{} of memory was not released", byte_size_text(now - memory_at_start));
}

int serve(MessageReader& reader) {
    const auto next = [&]() -> std::optional<std::string> {
        for (;;) {
            if (std::optional<std::string> message = reader.next()) return message;
            if (reader.receive(true) == MessageReader::Arrival::end) return std::nullopt;
        }
    };
    const std::optional<std::string> first = next();
    if (!first) return 0;
    const WorkerStart start = start_from(*first);
    prepare_process(start);
    Sender sender;
    std::unique_ptr<Cache> cache;
    if (!start.cache_folder.empty())
        cache = std::make_unique<Cache>(start.cache_folder, Cache::largest_default_limit,
                                        [&](std::string text) { sender.send({.note = std::move(text)}); });
    FilterLibrary library(plugin_folders());
    RunValues values(start.values);
    Workbench bench(library, cache.get(), static_cast<KeepRule::Policy>(start.keep_policy), values, start.scratch);
    if (content_hash(core_library_file()) != start.core_build)
        throw Error("Scanmill was reinstalled during the run; run it again");
    const u64 memory_at_start = anonymous_memory();
    const std::size_t files_at_start = open_files();
    const JobListener listener{[&](double fraction) { sender.send_progress(fraction); },
                               [&](std::string_view text) { sender.send({.warning = std::string(text)}); },
                               [] { return cancel_requested != 0; },
                               [&](std::string module) { sender.send({.loading = std::move(module)}); }};
    sender.send({.is_ready = true});
    while (const std::optional<std::string> message = next()) {
        JobReport report = bench.perform(job_from(*message, library), listener);
        std::fflush(nullptr);
        report.wear = leak(memory_at_start, files_at_start);
        sender.send({.report = std::move(report)});
    }
    return 0;
}

}  // namespace

int serve_as_worker() {
    int type = 0;
    socklen_t size = sizeof type;
    if (::getsockopt(worker_channel, SOL_SOCKET, SO_TYPE, &type, &size) != 0) {
        std::fprintf(stderr, "error: only scanmill itself starts workers, for run and batch\n");
        return 2;
    }
    MessageReader reader(worker_channel);
    try {
        return serve(reader);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());  // the runner puts the last lines into its message
        return 1;
    }
}

}  // namespace scanmill
