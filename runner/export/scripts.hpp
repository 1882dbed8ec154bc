// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The scripts of an exported batch, which run its chunks with a scheduler, merge them and write the report page.

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace scanmill::runner {

/// What the scripts need to know. The folders are absolute paths.
struct ExportPlan {
    std::string name;                 ///< name of the batch
    std::string batch;                ///< the file, as the user named it
    std::filesystem::path directory;  ///< the jobs work in it, so that they name scans as a run of the user does
    std::filesystem::path folder;     ///< has the scripts, the chunks and their outputs
    std::filesystem::path result;     ///< output folder of the merged run
    std::filesystem::path cache;      ///< empty: the default
    std::string program;              ///< command that starts Scanmill
    bool has_page = true;             ///< whether the program can write the report page
    std::size_t chunks = 0;
    unsigned cores = 1, megabytes = 0, minutes = 0;  ///< what a chunk gets
    unsigned merge_megabytes = 0, merge_minutes = 0;
};

/// How often a chunk runs if the machine runs out of memory or disk; every time with twice the memory.
inline constexpr unsigned most_attempts = 3;

/// Contents by file name.
using Scripts = std::map<std::string, std::string>;

/// run.sbatch, merge.sbatch and submit.sh.
Scripts slurm_scripts(const ExportPlan& plan);

/// Snakefile.
Scripts snakemake_scripts(const ExportPlan& plan);

/// The template with the values in place of @name@. Pre: every such name in it has a value.
std::string filled(std::string_view pattern, const std::map<std::string, std::string, std::less<>>& values);

/// Commands of the jobs. `chunk` and `jobs`: shell text for the number of the chunk, as 0003, and of the cores.
std::string batch_command(const ExportPlan& plan, const std::string& chunk, const std::string& jobs);
std::string merge_command(const ExportPlan& plan);
/// Writes the report page; does nothing if the program has none.
std::string page_command(const ExportPlan& plan);

/// Shell text that prints an error if the exit code `$code` says that the program is missing. `node`: shell text for
/// the name of the machine.
std::string missing_program(const ExportPlan& plan, const std::string& node);

}  // namespace scanmill::runner
