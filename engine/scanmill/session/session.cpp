// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/session.hpp"

#include <fmt/format.h>
#include <gnu/libc-version.h>
#include <sched.h>
#include <sys/utsname.h>
#include <tbb/version.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <cerrno>
#include <fstream>
#include <set>
#include <thread>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/graph/output_files.hpp"
#include "scanmill/io/atomic_file.hpp"
#include "scanmill/records/reasons.hpp"
#include "scanmill/records/recorder.hpp"
#include "scanmill/worker/resources.hpp"
#include "scanmill/worker/worker_processes.hpp"
#include "scanmill/worker/workers.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

/// Creates the folder if needed. Throws Error if outputs cannot be written to it.
void require_writable(const fs::path& folder) {
    std::error_code trouble;
    fs::create_directories(folder, trouble);
    if (!trouble && ::access(folder.c_str(), W_OK | X_OK) != 0) trouble.assign(errno, std::generic_category());
    if (trouble)
        throw Error("results cannot be written to '{}': {}", folder.string(), trouble.message())
            .hint("choose another output folder")
            .remedy(Remedy::choose_output_folder);
}

/// Removes incomplete output files of a run that was killed.
void remove_incomplete_outputs(const RunGraph& graph) {
    std::set<fs::path> folders;
    for (const RunCell& cell : graph.cells)
        for (const RunOutput& output : cell.outputs) {
            folders.insert(output.file.parent_path());
            folders.insert(failed_of(graph.output_folder, output.file).parent_path());
        }
    for (const fs::path& folder : folders) remove_abandoned_parts(folder);
}

/// The graph with only the complete cells, and without outputs. Nodes that no complete cell needs do not run.
RunGraph graph_of_costs(const RunGraph& graph, const RunReport& report) {
    RunGraph again = graph;
    again.cells.clear();
    for (std::size_t cell = 0; cell < graph.cells.size(); ++cell) {
        if (report.cells[cell].outcome > Outcome::doubtful) continue;
        again.cells.push_back(graph.cells[cell]);
        again.cells.back().outputs.clear();
    }
    return again;
}

/// Passes only time_passed() on to the observers.
struct Clock : RunObserver {
    explicit Clock(const std::vector<RunObserver*>& all) : observers(all) {}
    void time_passed() override {
        for (RunObserver* observer : observers) observer->time_passed();
    }
    const std::vector<RunObserver*>& observers;
};

std::string processor() {
    std::ifstream properties("/proc/cpuinfo");
    for (std::string line; std::getline(properties, line);)
        if (line.starts_with("model name")) return line.substr(std::min(line.size(), line.find(": ") + 2));
    return "unknown processor";
}

}  // namespace

Session::Session(SessionSettings settings, Cache* cache) : settings_(std::move(settings)), cache_(cache) {
    if (settings_.jobs == 0u || settings_.worker_command.empty()) return;
    WorkerProcessSettings workers;
    workers.command = settings_.worker_command;
    if (cache_) workers.cache_folder = cache_->folder().string();
    workers.keep_policy = static_cast<int>(settings_.keep);
    workers.on_note = [warn = warn_](std::string text) {
        if (*warn) (*warn)(std::move(text));
    };
    processes_ = std::make_unique<WorkerProcesses>(std::move(workers));
    try {
        processes_->start_early();
    } catch (const Error&) {
        // Ignored: the first job tries to start the process again and reports the failure.
    }
}

Session::~Session() = default;

std::vector<NodePrediction> Session::predict(const RunGraph& graph, FilterLibrary& library) const {
    std::vector<NodePrediction> predictions = scanmill::predict(graph, cache_, settings_.keep);
    const fs::path records = settings_.output_folder / records_file;
    std::error_code absent;
    if (!cache_ || !fs::exists(records, absent)) return predictions;
    try {
        explain(predictions, library, graph, RunRecords::read(records));
    } catch (const Error& error) {
        if (*warn_) (*warn_)(fmt::format("the changes since the last run are unknown: {}", error.sentence()));
    }
    return predictions;
}

unsigned Session::jobs(const RunGraph& graph) const {
    if (settings_.jobs) return *settings_.jobs;
    const u64 held = available_memory() / std::max<u64>(1, memory_need(graph));
    return static_cast<unsigned>(std::clamp<u64>(std::min<u64>(graph.cells.size(), held), 1, usable_cores()));
}

RunReport Session::run(const SessionTask& task, unsigned jobs, FilterLibrary& library,
                       std::vector<NodePrediction> predictions, const std::vector<RunObserver*>& observers,
                       const std::function<void(const RunStarted&)>& on_start) {
    require_writable(settings_.output_folder);
    const std::function<void(std::string)> warn = [warn = warn_](std::string text) {
        if (*warn) (*warn)(std::move(text));
    };
    const OutputLock lock(settings_.output_folder, settings_.command_line, warn);
    remove_incomplete_outputs(task.graph);
    if (jobs == 0 && (task.limits.cell_seconds > 0 || task.limits.step_seconds > 0))
        warn("time limits are not enforced without worker processes");
    if (cache_ && task.gate.repeats > 1) warn("costs are not measured, because this run uses a cache");
    RunSettings run_settings;
    run_settings.threads =
        settings_.threads > 0 ? settings_.threads : std::max(1u, usable_cores() / std::max(1u, jobs));
    run_settings.limits = task.limits;
    run_settings.fail_fast = settings_.fail_fast;
    run_settings.cache = cache_;
    run_settings.prediction = std::move(predictions);
    run_settings.is_cancelled = settings_.is_cancelled;
    std::unique_ptr<Workers> in_process;
    if (processes_)
        processes_->resize(jobs);
    else
        in_process = std::make_unique<InProcessWorker>(library, cache_, settings_.keep, settings_.is_cancelled);
    Workers& workers = processes_ ? static_cast<Workers&>(*processes_) : *in_process;

    RunStart start;
    start.workflow = task.name;
    start.file = task.file;
    start.arguments = settings_.command_line;
    start.seed = task.graph.seed;
    start.threads = run_settings.threads;
    start.jobs = jobs;
    start.version = SCANMILL_VERSION;
    start.machine = machine_text();
    start.libraries = libraries_text();
    for (const GateRule& rule : task.gate.rules) start.gate.emplace_back(rule.metric, rule.text);
    start.repeats = task.gate.repeats;
    start.folder = task.graph.output_folder.string();
    std::error_code unknown;
    start.working_folder = fs::current_path(unknown).string();
    start.shard = task.shard;
    start.key_of_cells = task.key_of_cells;
    Recorder recorder(settings_.output_folder / records_file, std::move(start), library, task.graph, warn, !cache_);
    on_start({jobs, run_settings.threads, recorder.run()});
    std::vector<RunObserver*> all = observers;
    all.push_back(&recorder);
    RunReport report = scanmill::run(library, task.graph, workers, run_settings, all);
    if (!cache_ && !(run_settings.fail_fast && report.outcome() >= Outcome::failed))
        measure_costs_again(task, library, workers, std::move(run_settings), report, recorder, all);
    if (processes_) processes_->dismiss();
    recorder.finish(report);
    if (cache_) cache_->evict();
    return report;
}

void Session::measure_costs_again(const SessionTask& task, FilterLibrary& library, Workers& workers,
                                  RunSettings run_settings, RunReport& report, Recorder& recorder,
                                  const std::vector<RunObserver*>& observers) {
    const RunGraph graph = graph_of_costs(task.graph, report);
    run_settings.prediction.clear();
    Clock clock(observers);
    for (unsigned pass = 2; pass <= task.gate.repeats && !report.interrupted && !graph.cells.empty(); ++pass) {
        for (RunObserver* observer : observers) observer->pass_started(pass, task.gate.repeats);
        const RunReport again = scanmill::run(library, graph, workers, run_settings, {&clock});
        recorder.add_pass(graph, again);
        report.interrupted = again.interrupted;
        const auto has_failed = [](const CellReport& cell) { return cell.outcome == Outcome::failed; };
        if (const auto failed = std::ranges::find_if(again.cells, has_failed); failed != again.cells.end() && *warn_)
            (*warn_)(
                fmt::format("when the costs were measured again, {} of {} failed, without effect on the results: {}",
                            std::ranges::count_if(again.cells, has_failed),
                            count_text(again.cells.size(), "cell", "cells"), failed->failure.error.sentence()));
    }
}

u64 memory_need(const RunGraph& graph) {
    constexpr u64 times_the_file = 100, times_a_streamed_file = 4;
    u64 most = 0;
    for (const RunNode& node : graph.nodes) {
        if (!node.is_scan) continue;
        std::error_code gone;
        const u64 bytes = std::filesystem::file_size(node.leaf.file, gone);
        if (!gone) most = std::max(most, bytes * (node.leaf.is_streamed ? times_a_streamed_file : times_the_file));
    }
    return most;
}

unsigned usable_cores() {
    cpu_set_t usable;
    if (::sched_getaffinity(0, sizeof usable, &usable) == 0) return static_cast<unsigned>(CPU_COUNT(&usable));
    return 1;
}

std::string machine_text() {
    utsname system{};
    ::uname(&system);
    const u64 memory = static_cast<u64>(::sysconf(_SC_PHYS_PAGES)) * static_cast<u64>(::sysconf(_SC_PAGESIZE));
    return fmt::format("{}, {}, {}, {} {} {}", processor(),
                       count_text(std::thread::hardware_concurrency(), "core", "cores"), byte_size_text(memory),
                       system.sysname, system.release, system.machine);
}

std::string libraries_text() {
    const std::string eigen = fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
    return fmt::format("Eigen {}, oneTBB {}, glibc {}, GCC {}", eigen, TBB_VERSION_STRING, ::gnu_get_libc_version(),
                       __VERSION__);
}

}  // namespace scanmill
