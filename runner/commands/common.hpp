// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Functions for several commands: the installed filters, a checked workflow, values of --set, units, the cache.

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "scanmill/cache/cache.hpp"
#include "scanmill/compare/comparison.hpp"
#include "scanmill/plan/plan.hpp"

namespace scanmill::runner {

/// Loads all usable filters. Warns on stderr of ignored entries of SCANMILL_PLUGIN_PATH.
FilterLibrary open_library();

/// The filter with this name. Throws Error for a filter that is not installed or whose module cannot be used.
const FilterSpec& find_filter(const FilterLibrary& library, const std::string& name);

struct CheckedWorkflow {
    Diagnostics diagnostics;
    Plan plan;  ///< may be run only if there are no errors
};

using Warn = std::function<void(std::string)>;

/// Checks the workflow in `text`, the content of `file`. With `has_picture`, the plan is that of
/// make_plan_with_picture().
CheckedWorkflow check_workflow(const std::string& file, const std::string& text, const FilterLibrary& library,
                               const Settings& settings, bool has_picture = false);

/// Parses the NAME=VALUE pairs of --set. Throws Error for any other text.
Settings parse_settings(const std::vector<std::string>& pairs);

/// Adds an option for a unit of length. If it is not given, `unit` is unchanged.
void add_unit_option(CLI::App& command, const char* name, LengthUnit& unit, const char* help);

/// Adds `--invalid drop|refuse`. If it is not given, `rule` is unchanged.
void add_invalid_option(CLI::App& command, InvalidRows& rule, const char* help);

/// gate_tripped if the gate tripped; otherwise some_failed if a cell failed or, with `strict`, is doubtful.
int exit_code_of(const Comparison& comparison, bool strict);

/// The largest value of `--jobs`.
inline constexpr unsigned most_jobs = 1024;

/// Prints warnings on stderr; prints equal sentences only once.
Warn warning_printer();

struct CacheOptions {
    std::string folder;
    std::optional<u64> limit;  ///< in bytes; absent: default_cache_limit()
};

/// Adds `--cache` and `--cache-limit`; returns the option `--cache`.
CLI::Option* add_cache_options(CLI::App& command, CacheOptions& options);

/// Opens the cache in the given folder, or in default_cache_folder() if none is given. Throws Error if the folder
/// cannot be used.
std::unique_ptr<Cache> open_cache(const CacheOptions& options, const Warn& warn);

}  // namespace scanmill::runner
