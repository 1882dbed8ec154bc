// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The commands. Each function adds a command to the parser; the command's action returns the exit code of the program.
/// Results go to stdout, everything else to stderr.

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace scanmill::runner {

/// 0: done. 1: some scans failed or an expectation was not met. 2: bad arguments or workflow, or a folder in use. 3:
/// internal error. 4: the gate of a batch tripped, whether or not scans failed. 5: in a shard or chunk, the machine ran
/// out of memory or disk, or the run is not recorded to its end, so that another run may succeed. 130: interrupted.
enum ExitCode {
    done = 0,
    some_failed = 1,
    bad_request = 2,
    our_fault = 3,
    gate_tripped = 4,
    machine_failed = 5,
    interrupted = 130
};

/// The action of the command that was chosen on the command line.
using Action = std::function<int()>;

/// Adds a command that calls `act` with its options. The caller declares the options on the returned command.
template <class Options>
std::pair<CLI::App&, Options&> add_command(CLI::App& parent, Action& chosen, const char* name, const char* help,
                                           int (*act)(const Options&)) {
    CLI::App* command = parent.add_subcommand(name, help);
    auto options = std::make_shared<Options>();
    command->callback([&chosen, options, act] { chosen = [options, act] { return act(*options); }; });
    return {*command, *options};
}

/// `command_line`: the program and its arguments, for the records.
void add_run_and_batch(CLI::App& app, Action& chosen, const std::vector<std::string>& command_line);
void add_export(CLI::App& app, Action& chosen);
void add_check(CLI::App& app, Action& chosen);
void add_list_and_show(CLI::App& app, Action& chosen);
void add_info(CLI::App& app, Action& chosen);
void add_convert(CLI::App& app, Action& chosen);
void add_measure(CLI::App& app, Action& chosen);
void add_schema_and_docs(CLI::App& app, Action& chosen);
void add_runs(CLI::App& app, Action& chosen, const std::vector<std::string>& command_line);
void add_report(CLI::App& app, Action& chosen);
void add_cache(CLI::App& app, Action& chosen);
void add_completion(CLI::App& app, Action& chosen);

}  // namespace scanmill::runner
