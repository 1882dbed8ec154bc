// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Carries out one `run` or `batch`, from a graph to its report. Chooses the numbers of worker processes and threads,
/// records the run, and evicts files from the cache.

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
        jobs;  ///< number of worker processes; 0: all work is done in this process; empty: see Session::jobs()
    unsigned threads = 0;          ///< threads inside a filter; 0: the cores are divided among the jobs
    bool fail_fast = false;
    KeepRule::Policy keep = KeepRule::Policy::worth;
    std::vector<std::string> worker_command;  ///< program and arguments of a worker process; empty: no worker processes
    std::vector<std::string> command_line;  ///< command line of this run, for the records
    std::function<bool()> is_cancelled;
};

/// A graph, and its name in the records.
struct SessionTask {
    std::string name, file;  ///< name and file of the workflow or the batch
    RunGraph graph;
    Limits limits;
    Gate gate{};  ///< gate of the batch; Gate::repeats has no effect if there is a cache
    std::string shard{}, key_of_cells{};  ///< as in RunStart; empty for a whole batch
};

/// Properties of a run that are known when it starts.
struct RunStarted {
    unsigned jobs = 0, threads = 0;
    std::int64_t run = 0;  ///< number of the run in the records; 0: the run is not recorded
};

class Session {
public:
    /// Starts the first worker process early, while the caller builds the graph. `cache` may be null.
    Session(SessionSettings settings, Cache* cache);
    ~Session();

    /// Receives every warning of the session and its workers.
    void on_warning(std::function<void(std::string)> warn) { *warn_ = std::move(warn); }

    /// Predicts which nodes will run and why. The records of the output folder give the changes since the last run.
    std::vector<NodePrediction> predict(const RunGraph& graph, FilterLibrary& library) const;

    /// The number of worker processes: SessionSettings::jobs if set. If not, it is limited by the number of cells, by
    /// the cores, and by the free memory, as if every job took the largest scan.
    unsigned jobs(const RunGraph& graph) const;

    /// Runs the graph, records the run, and evicts files from the cache if its limit is exceeded. Throws Error if
    /// results cannot be written to the output folder, and FolderInUse if another run writes into it.
    ///
    /// Without a cache, complete cells run again until their costs were measured Gate::repeats times. These passes
    /// write no outputs. `on_start` is called once, before the first step. `jobs` is the result of jobs(), which
    /// depends on the free memory and may change between calls.
    RunReport run(const SessionTask& task, unsigned jobs, FilterLibrary& library,
                  std::vector<NodePrediction> predictions, const std::vector<RunObserver*>& observers,
                  const std::function<void(const RunStarted&)>& on_start);

private:
    /// Runs further passes and adds their costs to the records.
    void measure_costs_again(const SessionTask& task, FilterLibrary& library, Workers& workers,
                             RunSettings run_settings, RunReport& report, Recorder& recorder,
                             const std::vector<RunObserver*>& observers);

    SessionSettings settings_;
    Cache* cache_;
    std::shared_ptr<std::function<void(std::string)>> warn_ = std::make_shared<std::function<void(std::string)>>();
    std::unique_ptr<WorkerProcesses> processes_;
};

/// An upper estimate of the memory, in bytes, that the graph needs for one scan; the largest over all scans. 0 if no
/// scan has a file. From binary coordinates to a mesh, a scan needs up to about a hundred times the size of its file.
/// Only a part of a streamed scan is in memory. If it must be loaded whole after all, it needs about four times its
/// size.
u64 memory_need(const RunGraph& graph);

/// The number of cores that this process may use.
unsigned usable_cores();

/// A description of the machine for the records: "AMD …, 8 cores, 31.3 GiB, Linux 6.1.0 x86_64".
std::string machine_text();
/// The libraries that results depend on and their versions, for the records.
std::string libraries_text();

}  // namespace scanmill
