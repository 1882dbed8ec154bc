// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/serve.hpp"

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
#include "scanmill/worker/messages.hpp"
#include "scanmill/worker/resources.hpp"
#include "scanmill/worker/workbench.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

namespace {

// The one thing a signal handler may touch.
volatile std::sig_atomic_t cancel_requested = 0;

/// Calls of its functions may come from any thread.
class Speaker {
public:
    void say(const WorkerMessage& message) {
        const std::scoped_lock one_at_a_time(mutex_);
        if (!send_message(worker_channel, to_message(message))) ::_exit(1);  // nobody is left to work for
    }
    void say_progress(double fraction) {
        constexpr std::chrono::milliseconds pause(100);
        const auto now = std::chrono::steady_clock::now();
        if (now - told_ < pause) return;
        told_ = now;
        say({.progress = fraction});
    }

private:
    std::mutex mutex_;
    std::chrono::steady_clock::time_point told_;
};

void prepare_process(const WorkerStart& start) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != start.parent) ::_exit(1);  // it ended before it could take us along
    std::signal(SIGTERM, [](int) { cancel_requested = 1; });
    std::signal(SIGINT, SIG_IGN);
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    // Where memory runs out for everybody, a worker goes before its runner and before other programs.
    std::ofstream("/proc/self/oom_score_adj") << "500";
}

/// Why this process should not go on although it holds nothing; empty when it may.
std::string what_memory_stayed(u64 before) {
    constexpr u64 tolerable = u64(256) << 20;
    if (anonymous_memory() < before + tolerable) return {};
    ::malloc_trim(0);
    const u64 memory = anonymous_memory();
    return memory < before + tolerable ? "" : fmt::format("{} of memory stay in use", byte_size_text(memory - before));
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
    Speaker speaker;
    std::unique_ptr<Cache> cache;
    if (!start.cache_folder.empty())
        cache = std::make_unique<Cache>(start.cache_folder, Cache::default_limit,
                                        [&](std::string text) { speaker.say({.note = std::move(text)}); });
    FilterLibrary library(plugin_folders());
    Workbench bench(library, cache.get(), static_cast<KeepRule::Policy>(start.keep_policy), start.scratch);
    if (content_hash(core_library_file()) != start.core_build)
        throw Error("Scanmill was installed anew while the run was going on; run it again");
    const u64 memory_before = anonymous_memory();
    const JobListener listener{[&](double fraction) { speaker.say_progress(fraction); },
                               [&](std::string_view text) { speaker.say({.warning = std::string(text)}); },
                               [] { return cancel_requested != 0; }};
    speaker.say({.is_ready = true});
    while (const std::optional<std::string> message = next()) {
        const ReceivedJob received = job_from(*message, library);
        for (const std::size_t node : received.forgotten) bench.forget(node);
        if (!received.job) continue;
        const std::string heavy = bench.is_empty() ? what_memory_stayed(memory_before) : "";
        const ProcessState before = ProcessState::now();
        JobReport report = bench.perform(*received.job, listener);
        std::fflush(nullptr);
        report.worn = ProcessState::now().changes_since(before);
        if (report.worn.empty()) report.worn = heavy;
        speaker.say({.report = std::move(report)});
    }
    return 0;
}

}  // namespace

int serve_as_worker() {
    int type = 0;
    socklen_t size = sizeof type;
    if (::getsockopt(worker_channel, SOL_SOCKET, SO_TYPE, &type, &size) != 0) {
        std::fprintf(stderr, "error: a worker is started by scanmill itself: by run and batch\n");
        return 2;
    }
    MessageReader reader(worker_channel);
    try {
        return serve(reader);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());  // the runner tells a process's last words
        return 1;
    }
}

}  // namespace scanmill
