// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Runs the built command as a user would, and says what came of it.

#include <filesystem>
#include <string>
#include <vector>

namespace scanmill::test {

struct ProgramResult {
    int exit_code = -1;  ///< of a normal end; -signal when a signal ended it
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
};

/// Runs SCANMILL_PROGRAM with these arguments and no standard input.
ProgramResult scanmill_program(const std::vector<std::string>& arguments, const ProgramOptions& options = {});

}  // namespace scanmill::test
