// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands/execute.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <limits>

#include "commands/commands.hpp"
#include "output/event_stream.hpp"
#include "output/printable.hpp"
#include "output/progress.hpp"
#include "output/run_output.hpp"
#include "output/stderr_text.hpp"

namespace scanmill::runner {

namespace {

// The one thing a signal handler may touch.
volatile std::sig_atomic_t interrupt_requested = 0;

void on_interrupt(int signal) {
    interrupt_requested = 1;
    std::signal(signal, SIG_DFL);  // a second one ends the program at once
}

/// The command line's own reading takes -1 for the largest number and 010 for eight.
template <class Number>
CLI::Validator whole_number() {
    return CLI::Validator(
        [](const std::string& text) -> std::string {
            Number ignored = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), ignored);
            const bool octal = text.size() > 1 && text[0] == '0';
            if (error == std::errc() && end == text.data() + text.size() && !octal) return {};
            return fmt::format("'{}' is no whole number from 0 to {}", text, std::numeric_limits<Number>::max());
        },
        "");
}

/// Empty when results can be put into the folder, which may have to be made.
std::string what_bars_folder(const std::string& folder) {
    if (folder.empty()) return "the output folder's name is empty";
    std::error_code ignored;
    for (std::filesystem::path part = folder; !part.empty(); part = part.parent_path()) {
        if (std::filesystem::is_directory(part, ignored)) break;
        if (std::filesystem::exists(part, ignored))
            return fmt::format("results cannot be put into '{}': '{}' is a file", folder, part.string());
        if (part == part.parent_path()) break;
    }
    return {};
}

constexpr unsigned most_jobs = 1024;

}  // namespace

std::unique_ptr<Session> open_session(const ExecuteOptions& options, Cache* cache) {
    SessionSettings settings;
    settings.output_folder = options.output_folder;
    settings.jobs = options.jobs;
    settings.threads = options.threads;
    settings.fail_fast = options.fail_fast;
    settings.keep = keep_policy(options.cache);
    if (!options.dry_run) settings.worker_command = {"/proc/self/exe", "worker"};
    settings.command_line = options.command_line;
    settings.is_cancelled = [] { return interrupt_requested != 0; };
    return std::make_unique<Session>(std::move(settings), cache);
}

void add_execute_options(CLI::App& command, ExecuteOptions& options) {
    command.add_option("-o,--output", options.output_folder, "The output folder")
        ->capture_default_str()
        ->check(CLI::Validator(what_bars_folder, ""));
    command
        .add_option("-j,--jobs", options.jobs,
                    "Worker processes: what crashes in one harms no other; 0: everything in this process, without "
                    "limits of time. Without it as many as the machine has cores, or fewer for large scans")
        ->check(whole_number<unsigned>())
        ->check(CLI::Range(0u, most_jobs));
    command
        .add_option("--threads", options.threads,
                    "Threads inside a filter; 0: the machine's cores shared among the jobs. Results do not depend on "
                    "it")
        ->capture_default_str()
        ->check(whole_number<unsigned>());
    command.add_option("--seed", options.seed, "Seed of everything random")
        ->capture_default_str()
        ->check(whole_number<std::uint64_t>());
    add_cache_options(command, options.cache, true);
    command.add_flag("--fail-fast", options.fail_fast, "Begin nothing new once something has failed");
    command.add_flag("--dry-run", options.dry_run,
                     "Print what would be run and why, what is cached, and what would be written, and stop");
    command.add_flag("-q,--quiet", options.quiet, "No progress on stderr");
}

int execute(const SessionTask& task, bool streams_events, Session& session, FilterLibrary& library, const Warn& warn,
            const ExecuteOptions& options) {
    const RunGraph& graph = task.graph;
    session.on_warning(warn);
    std::vector<NodePrediction> predictions = session.predict(graph, library);
    if (options.dry_run) {
        fmt::print("{}",
                   options.json ? graph_json(graph, predictions) + "\n" : printable(graph_text(graph, predictions)));
        return done;
    }

    std::signal(SIGPIPE, SIG_IGN);  // the work goes on when whoever reads the output ends
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    Progress progress(graph, predictions, std::max(1u, session.jobs(graph)), options.quiet);
    session.on_warning([&](std::string text) { progress.say_beside([&] { warn(std::move(text)); }); });
    std::optional<EventStream> events;
    std::vector<RunObserver*> observers{&progress};
    if (options.json && streams_events) observers.push_back(&events.emplace(graph));
    const RunReport report = session.run(task, library, std::move(predictions), observers, [&](const RunStarted& run) {
        if (events) events->begin(task.name, run.jobs, run.threads, run.run);
    });
    progress.finish();
    session.on_warning(warn);

    if (events) {
        events->end(report);
        if (events->has_failed()) {
            tell("error: not all events could be written\n");
            return our_fault;
        }
    } else {
        fmt::print("{}", options.json ? report_json(graph, report) + "\n" : report_text(graph, report));
    }
    if (report.interrupted) {
        tell("interrupted; what was written is whole\n");
        return interrupted;
    }
    return report.all_done() ? done : some_failed;
}

}  // namespace scanmill::runner
