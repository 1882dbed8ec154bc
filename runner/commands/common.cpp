// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands/common.hpp"

#include "commands/commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/plan/pictures.hpp"
#include "scanmill/plugin/module.hpp"
#include "scanmill/workflow/ready.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill::runner {

FilterLibrary open_library() {
    std::vector<std::string> ignored;
    FilterLibrary library(plugin_folders(&ignored));
    for (const std::string& folder : ignored)
        print_warning(fmt::format("SCANMILL_PLUGIN_PATH: '{}' is ignored; only absolute folders are searched", folder));
    return library;
}

const FilterSpec& find_filter(const FilterLibrary& library, const std::string& name) {
    if (const FilterSpec* spec = library.find(name)) return *spec;
    for (const UnusableModule& module : library.unusable())
        if (module.name == name)
            throw Error("the filter '{}' cannot be used: '{}' {}", name, module.manifest.string(), module.reason);
    const bool is_ready = std::ranges::count(ready_names(), name) > 0;
    throw Error("there is no filter '{}'{}", name,
                is_ready ? "; it is a ready workflow or batch" : did_you_mean(name, library.names()))
        .hint(is_ready ? "scanmill check " + name + " --plan" : "scanmill list");
}

CheckedWorkflow check_workflow(const std::string& file, const std::string& text, const FilterLibrary& library,
                               const Settings& settings, bool has_picture) {
    Diagnostics diagnostics(file);
    Workflow workflow = parse_workflow(text, diagnostics);
    Plan plan = has_picture ? make_plan_with_picture(std::move(workflow), library, settings, diagnostics)
                            : make_plan(std::move(workflow), library, settings, diagnostics);
    return {std::move(diagnostics), std::move(plan)};
}

Settings parse_settings(const std::vector<std::string>& pairs) {
    Settings settings;
    for (const std::string& pair : pairs) {
        const std::size_t equals = pair.find('=');
        if (equals == 0 || equals == std::string::npos) throw Error("--set {}: expected NAME=VALUE", pair);
        Diagnostics diagnostics("--set " + pair);
        ValueExpression value = parse_value_expression(pair.substr(equals + 1), diagnostics);
        refuse_uses(value, "a setting", diagnostics);
        if (value.values.empty() && !diagnostics.has_errors()) diagnostics.error({}, "has no value");
        if (diagnostics.has_errors()) throw Error("--set {}: {}", pair, diagnostics.sorted().front().message);
        if (!settings.emplace(pair.substr(0, equals), std::move(value)).second)
            throw Error("--set {} is given twice", pair.substr(0, equals));
    }
    return settings;
}

void add_unit_option(CLI::App& command, const char* name, LengthUnit& unit, const char* help) {
    const auto read = [&unit](const std::string& symbol) { unit = *length_unit(symbol); };
    command.add_option_function<std::string>(name, read, help)
        ->check(CLI::IsMember({"um", "mm", "cm", "m", "in", "ft"}));
}

void add_invalid_option(CLI::App& command, InvalidRows& rule, const char* help) {
    const auto read = [&rule](const std::string& name) { rule = *invalid_rows_named(name); };
    command.add_option_function<std::string>("--invalid", read, help)->check(CLI::IsMember({"drop", "refuse"}));
}

int exit_code_of(const Comparison& comparison, bool strict) {
    if (comparison.tripped()) return gate_tripped;
    const bool fails = comparison.count(Verdict::failed) > 0 || (strict && comparison.count(Verdict::doubtful) > 0);
    return fails ? some_failed : done;
}

Warn warning_printer() {
    return [printed = std::make_shared<std::set<std::string>>()](const std::string& text) {  // shared by all copies
        if (printed->insert(text).second) print_warning(text);
    };
}

CLI::Option* add_cache_options(CLI::App& command, CacheOptions& options) {
    command.add_option_function<std::string>(
        "--cache-limit", [&](const std::string& size) { options.limit = parse_byte_size(size); },
        fmt::format("Size limit, such as 500 MiB or 20 GiB; results used longest ago are removed first. Default: 10 % "
                    "of the disk that holds the cache, at most {}",
                    byte_size_text(Cache::largest_default_limit)));
    return command.add_option(
        "--cache", options.folder,
        "The cache's folder. Default: $XDG_CACHE_HOME/scanmill, or ~/.cache/scanmill if that is not set");
}

std::unique_ptr<Cache> open_cache(const CacheOptions& options, const Warn& warn) {
    std::filesystem::path folder =
        options.folder.empty() ? default_cache_folder() : std::filesystem::absolute(options.folder);
    const u64 limit = options.limit ? *options.limit : default_cache_limit(folder);
    return std::make_unique<Cache>(std::move(folder), limit, warn);
}

}  // namespace scanmill::runner
