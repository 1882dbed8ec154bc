// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Running a graph from the command line: what `run` and `batch` have in common once they know what is to be done.

#include <CLI/CLI.hpp>

#include <memory>

#include "commands/cache_options.hpp"
#include "scanmill/session/session.hpp"

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

/// The session for these options; no worker process starts for a dry run.
std::unique_ptr<Session> open_session(const ExecuteOptions& options, Cache* cache);

/// Prints what would be done, with --dry-run, or does it and prints the report; with `streams_events`, --json prints
/// one event per line while the run goes on. Returns the exit code.
int execute(const SessionTask& task, bool streams_events, Session& session, FilterLibrary& library, const Warn& warn,
            const ExecuteOptions& options);

}  // namespace scanmill::runner
