// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// One `run` or `batch`, from a graph to its report: chooses the number of worker processes and threads, records the
/// run, and evicts from the cache.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/batch/batch.hpp"
#include "scanmill/cache/cache.hpp"
#include "scanmill/run/run.hpp"
#include "scanmill/session/output_lock.hpp"

namespace scanmill {

class Recorder;
class WorkerProcesses;

struct SessionSettings {
    std::filesystem::path output_folder;
    std::optional<unsigned>
        jobs;  ///< worker processes; 0: everything runs in this process; nothing: see Session::jobs()
    unsigned threads = 0;          ///< inside a filter; 0: the cores shared among the jobs
    bool fail_fast = false;
    KeepRule::Policy keep = KeepRule::Policy::worth;
    std::vector<std::string> worker_command;  ///< the program and its arguments; empty: no worker process is started
    std::vector<std::string> command_line;    ///< for the records
    std::function<bool()> is_cancelled;
};

/// A graph, and its name in the records.
struct SessionTask {
    std::string name, file;  ///< of the workflow or the batch
    RunGraph graph;
    Limits limits;
    Gate gate{};  ///< gate of the batch; its repeats need a run without a cache
};

/// What is decided when a run starts.
struct RunStarted {
    unsigned jobs = 0, threads = 0;
    std::int64_t run = 0;  ///< its number in the records; 0: it is not recorded
};

class Session {
public:
    /// Starts the first worker process, so that it is ready when the graph is. `cache` may be null.
    Session(SessionSettings settings, Cache* cache);
    ~Session();

    /// Receives every warning of the session and its workers.
    void on_warning(std::function<void(std::string)> warn) { *warn_ = std::move(warn); }

    /// Which nodes will run and why; what changed since the last run into the same folder is taken from its records.
    std::vector<NodePrediction> predict(const RunGraph& graph, FilterLibrary& library) const;

    /// The set number; else limited by cells, cores and memory, as if each job took the largest scan.
    unsigned jobs(const RunGraph& graph) const;

    /// Runs the graph, records the run, and evicts from the cache what exceeds its limit. Throws Error when results
    /// cannot be written to the output folder, and FolderInUse when another run writes into it. Without a cache, the
    /// complete cells run again, until the task's number of measurements is reached; these passes write no
    /// outputs. `on_start` is called once, before the first step. `jobs`: from jobs(),
    /// which depends on the free memory.
    RunReport run(const SessionTask& task, unsigned jobs, FilterLibrary& library,
                  std::vector<NodePrediction> predictions, const std::vector<RunObserver*>& observers,
                  const std::function<void(const RunStarted&)>& on_start);

private:
    /// Adds the costs of further passes to the records.
    void measure_costs_again(const SessionTask& task, FilterLibrary& library, Workers& workers,
                             RunSettings run_settings, RunReport& report, Recorder& recorder,
                             const std::vector<RunObserver*>& observers);

    SessionSettings settings_;
    Cache* cache_;
    std::shared_ptr<std::function<void(std::string)>> warn_ = std::make_shared<std::function<void(std::string)>>();
    std::unique_ptr<WorkerProcesses> processes_;
};

/// An upper estimate, in bytes, of what one scan needs on its way through the graph, for the scan that needs most; 0
/// when no scan has a file. Binary coordinates grow by up to about a hundred times on the way to a mesh. A streamed
/// scan keeps only a part; if it must be read as a whole after all, it needs about four times its size.
u64 memory_need(const RunGraph& graph);

/// Cores that this process may use.
unsigned usable_cores();

/// "AMD …, 8 cores, 31.3 GiB, Linux 6.1.0 x86_64", for records.
std::string machine_text();
/// The libraries that results depend on, with their versions, for records.
std::string libraries_text();

}  // namespace scanmill
