// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands/execute.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <limits>
#include <set>

#include "commands/commands.hpp"
#include "output/event_stream.hpp"
#include "output/printable.hpp"
#include "output/progress.hpp"
#include "output/run_output.hpp"
#include "output/stderr_text.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/io/atomic_file.hpp"
#include "scanmill/records/reasons.hpp"
#include "scanmill/records/recorder.hpp"
#include "scanmill/run/run.hpp"
#include "scanmill/session/machine.hpp"
#include "scanmill/session/memory_need.hpp"
#include "scanmill/worker/resources.hpp"
#include "scanmill/worker/worker_processes.hpp"
#include "scanmill/worker/workers.hpp"

namespace scanmill::runner {

namespace {

// The one thing a signal handler may touch.
volatile std::sig_atomic_t interrupt_requested = 0;

void on_interrupt(int signal) {
    interrupt_requested = 1;
    std::signal(signal, SIG_DFL);  // a second one ends the program at once
}

/// Better before the first step than after the last.
void require_writable(const std::filesystem::path& folder) {
    std::error_code trouble;
    std::filesystem::create_directories(folder, trouble);
    if (!trouble && ::access(folder.c_str(), W_OK | X_OK) != 0) trouble.assign(errno, std::generic_category());
    if (trouble)
        throw Error("results cannot be put into '{}': {}", folder.string(), trouble.message())
            .hint("name another output folder: -o DIR");
}

/// What changed since the last run into the same folder; without records of one nothing is known.
void explain_from_records(std::vector<NodeForesight>& foresight, FilterLibrary& library, const RunGraph& graph,
                          const std::filesystem::path& folder, const Warn& warn) {
    const std::filesystem::path file = folder / records_file;
    std::error_code absent;
    if (!std::filesystem::exists(file, absent)) return;
    try {
        explain(foresight, library, graph, RunRecords::read(file));
    } catch (const Error& error) {
        warn(fmt::format("what changed since the last run is not known: {}", error.sentence()));
    }
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

/// As many as there is work for and cores, and as memory allows when each takes the largest scan.
unsigned default_jobs(const RunGraph& graph) {
    const u64 held = available_memory() / std::max<u64>(1, memory_need(graph));
    return static_cast<unsigned>(std::clamp<u64>(std::min<u64>(graph.cells.size(), held), 1, cores()));
}

}  // namespace

Workforce::Workforce(const ExecuteOptions& options, const Cache* cache) {
    if (options.jobs == 0u || options.dry_run) return;
    WorkerProcessSettings settings;
    settings.command = {"/proc/self/exe", "worker"};
    if (cache) settings.cache_folder = cache->folder().string();
    settings.keep_policy = static_cast<int>(keep_policy(options.cache));
    settings.on_note = [warn = warn_](std::string text) {
        if (*warn) (*warn)(std::move(text));
    };
    processes_ = std::make_unique<WorkerProcesses>(std::move(settings));
    try {
        processes_->start_early();
    } catch (const Error&) {
        // It is tried again, and told, when there is work.
    }
}

Workforce::~Workforce() = default;

unsigned cores() {
    cpu_set_t usable;
    if (::sched_getaffinity(0, sizeof usable, &usable) == 0) return static_cast<unsigned>(CPU_COUNT(&usable));
    return 1;
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

int execute(const Task& task, FilterLibrary& library, Cache* cache, Workforce& workforce, const Warn& warn,
            const ExecuteOptions& options) {
    const RunGraph& graph = task.graph;
    std::vector<NodeForesight> foresight = foresee(graph, cache, keep_policy(options.cache));
    if (cache) explain_from_records(foresight, library, graph, options.output_folder, warn);
    if (options.dry_run) {
        fmt::print("{}", options.json ? graph_json(graph, foresight) + "\n" : printable(graph_text(graph, foresight)));
        return done;
    }

    require_writable(options.output_folder);
    std::set<std::filesystem::path> folders;
    for (const RunCell& cell : graph.cells)
        for (const RunOutput& output : cell.outputs) folders.insert(output.file.parent_path());
    for (const std::filesystem::path& folder : folders) remove_abandoned_parts(folder);

    const unsigned jobs = options.jobs ? *options.jobs : default_jobs(graph);
    if (jobs == 0 && (task.limits.cell_seconds > 0 || task.limits.step_seconds > 0))
        warn("with -j 0 no limit of time is kept");
    RunSettings settings;
    settings.threads = options.threads > 0 ? options.threads : std::max(1u, cores() / std::max(1u, jobs));
    settings.limits = task.limits;
    settings.fail_fast = options.fail_fast;
    settings.cache = cache;
    settings.shares_values = jobs > 0 && cache && keep_policy(options.cache) != KeepRule::Policy::never;
    settings.foresight = std::move(foresight);
    settings.is_cancelled = [] { return interrupt_requested != 0; };
    std::signal(SIGPIPE, SIG_IGN);  // whoever reads what is said may go: the work goes on
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    Progress progress(graph, settings.foresight, std::max(1u, jobs), options.quiet);
    const Warn warn_beside = [&](std::string text) { progress.say_beside([&] { warn(std::move(text)); }); };
    workforce.tell(warn_beside);
    std::unique_ptr<Workers> in_process;
    if (!workforce.processes())
        in_process =
            std::make_unique<InProcessWorker>(library, cache, keep_policy(options.cache), settings.is_cancelled);
    else
        workforce.processes()->resize(jobs);
    Workers& workers = in_process ? *in_process : *workforce.processes();

    std::optional<EventStream> events;
    RunStart start{task.name, task.file,        options.command_line, graph.seed,      settings.threads,
                   jobs,      SCANMILL_VERSION, machine_text(),       libraries_text()};
    Recorder recorder(std::filesystem::path(options.output_folder) / records_file, std::move(start), library, graph,
                      warn_beside);
    std::vector<RunObserver*> observing{&progress, &recorder};
    if (options.json && task.streams_events) observing.push_back(&events.emplace(graph));
    if (events) events->begin(task.name, jobs, settings.threads, recorder.run());
    Observers observers(observing);
    const RunReport report = run(library, graph, workers, settings, observers);
    progress.finish();
    if (workforce.processes()) workforce.processes()->dismiss();
    recorder.finish(report);
    if (cache) cache->evict();

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
