// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Runs the built command as a user would, and says what came of it.

#include <filesystem>
#include <string>
#include <vector>

#include "support/folders.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {

struct ProgramResult {
    int exit_code = -1;  ///< exit code after a normal end; -signal when a signal ended it
    std::string out, err;
};

struct ProgramOptions {
    std::filesystem::path folder{};               ///< to run in; empty: this one
    std::vector<std::string> environment{};       ///< NAME=VALUE, added
    std::size_t memory_limit = 0;                 ///< bytes of address space; 0: none
    std::size_t file_limit = 0;                   ///< bytes of any file that it writes; 0: none
    std::size_t seconds_limit = 0;                ///< of processor time, then it is killed; 0: none
    std::filesystem::path cache{};                ///< XDG_CACHE_HOME; empty: a new one, removed afterwards
    bool without_rights = false;                  ///< as the user `nobody`, when we are root
    bool own_group = false;                       ///< in a process group of its own, for signal_group()
};

/// The program with these arguments and no standard input, while it runs.
class RunningProgram {
public:
    explicit RunningProgram(const std::vector<std::string>& arguments, const ProgramOptions& options = {});
    /// Ends it by force.
    ~RunningProgram();
    RunningProgram(const RunningProgram&) = delete;
    RunningProgram& operator=(const RunningProgram&) = delete;

    void signal(int number) const;
    /// To it and all processes that it started.
    void signal_group(int number) const;
    /// Whether it has ended.
    bool has_ended();
    /// Waits for its end.
    ProgramResult wait();
    /// What it wrote until now.
    std::string out() const;
    std::string err() const;
    int process() const { return process_; }

private:
    TemporaryFolder folder_;
    int process_ = -1;
    bool has_ended_ = false;
    int status_ = 0;
};

/// Runs it to its end. What it prints with --json must be as the schemas say.
ProgramResult scanmill_program(const std::vector<std::string>& arguments, const ProgramOptions& options = {});

}  // namespace scanmill::test
