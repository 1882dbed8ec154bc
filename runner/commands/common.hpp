// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What several commands use: the installed filters, a checked workflow, values of --set, units, the cache.

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>

#include "scanmill/cache/cache.hpp"
#include "scanmill/compare/comparison.hpp"
#include "scanmill/plan/plan.hpp"

namespace scanmill::runner {

/// All usable filters. Ignored entries of SCANMILL_PLUGIN_PATH are warned of on stderr.
FilterLibrary open_library();

/// The filter. Throws Error for a filter that is not installed or whose module cannot be used.
const FilterSpec& find_filter(const FilterLibrary& library, const std::string& name);

struct CheckedWorkflow {
    Diagnostics diagnostics;
    Plan plan;  ///< to be run only without errors
};

/// The file, or the shipped workflow of that name if there is no such file.
std::string workflow_file(const std::string& file_or_name);

/// Checks the workflow in `text`, the content of `file`.
CheckedWorkflow check_workflow(const std::string& file, const std::string& text, const FilterLibrary& library,
                               const Settings& settings);

/// NAME=VALUE pairs of --set. Throws Error for anything else.
Settings parse_settings(const std::vector<std::string>& pairs);

/// Adds an option for a unit of length; without it `unit` is unknown.
void add_unit_option(CLI::App& command, const char* name, LengthUnit& unit, const char* help);

/// Adds `--invalid drop|refuse`; without it `rule` is by_format.
void add_invalid_option(CLI::App& command, InvalidRows& rule, const char* help);

/// 4 if the gate tripped, else 1 if a cell failed or, with `strict`, is doubtful.
int exit_code_of(const Comparison& comparison, bool strict);

using Warn = std::function<void(std::string)>;

/// Prints warnings on stderr, equal sentences once.
Warn warning_printer();

struct CacheOptions {
    std::string folder;
    u64 limit = Cache::default_limit;
};

/// Adds `--cache`, which it returns, and `--cache-limit`.
CLI::Option* add_cache_options(CLI::App& command, CacheOptions& options);

/// The cache in the given folder, else in default_cache_folder(). Throws Error when there is no such folder.
std::unique_ptr<Cache> open_cache(const CacheOptions& options, const Warn& warn);

}  // namespace scanmill::runner
