// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Running a graph from the command line: what `run` and `batch` have in common once they know what is to be done.

#include <CLI/CLI.hpp>

#include <memory>

#include "commands/cache_options.hpp"
#include "scanmill/batch/batch.hpp"
#include "scanmill/graph/graph.hpp"

namespace scanmill {
class WorkerProcesses;
}

namespace scanmill::runner {

struct ExecuteOptions {
    std::string output_folder = "scanmill-out";
    std::optional<unsigned> jobs;  ///< nothing: as the work and the machine allow
    unsigned threads = 0;
    std::uint64_t seed = 0;
    bool dry_run = false, json = false, quiet = false, fail_fast = false;
    CacheOptions cache;
    std::vector<std::string> command_line;
};

void add_execute_options(CLI::App& command, ExecuteOptions& options);

/// A graph, and how it is called in the records.
struct Task {
    std::string name, file;  ///< of the workflow or the batch
    RunGraph graph;
    Limits limits;
    bool streams_events = false;  ///< --json prints what happens as it happens, a line each; else a report at the end
};

/// Worker processes, the first of which starts while there is still much to be read and planned. None with -j 0.
class Workforce {
public:
    Workforce(const ExecuteOptions& options, const Cache* cache);
    ~Workforce();

    WorkerProcesses* processes() { return processes_.get(); }
    /// Who is told what workers say of their surroundings.
    void tell(Warn warn) { *warn_ = std::move(warn); }

private:
    std::shared_ptr<Warn> warn_ = std::make_shared<Warn>();
    std::unique_ptr<WorkerProcesses> processes_;
};

/// Prints what would be done, with --dry-run, or does it. Returns the exit code.
int execute(const Task& task, FilterLibrary& library, Cache* cache, Workforce& workforce, const Warn& warn,
            const ExecuteOptions& options);

/// Cores that this process may use.
unsigned cores();

}  // namespace scanmill::runner
