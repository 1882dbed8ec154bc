// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "output/terminal.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill::runner {

namespace {

struct Options {
    CacheOptions cache;
    bool json = false;
};

nlohmann::ordered_json uses_json(const char* key, const std::vector<CacheUse>& uses) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const CacheUse& use : uses) {
        nlohmann::ordered_json entry;
        entry[key] = use.name;
        entry["bytes"] = use.bytes;
        list.push_back(std::move(entry));
    }
    return list;
}

/// The heading, then a line for each use; empty if no file is used.
std::string uses_text(const char* heading, const std::vector<CacheUse>& uses) {
    std::size_t width = 0;
    for (const CacheUse& use : uses) width = std::max(width, columns_of(printable_line(use.name)));
    std::string text;
    for (const CacheUse& use : uses) {
        const std::string name = printable_line(use.name);
        const std::string padding(width - columns_of(name), ' ');
        if (use.bytes > 0) text += fmt::format("  {}{}  {}\n", name, padding, byte_size_text(use.bytes));
    }
    return text.empty() ? text : fmt::format("{}\n{}", heading, text);
}

int info(const Options& options) {
    const CacheInfo info = open_cache(options.cache, {})->info();
    const std::string folder = info.folder.string();
    if (options.json)
        print_json({{"scanmill", 1},
                    {"folder", folder},
                    {"steps", info.steps},
                    {"values", info.values},
                    {"bytes", info.bytes},
                    {"limit", info.limit},
                    {"by-filter", uses_json("filter", info.by_filter)},
                    {"by-workflow", uses_json("workflow", info.by_workflow)},
                    {"by-age", uses_json("used", info.by_age)}});
    else
        fmt::print("folder  {}\nsteps   {}\nvalues  {}\nsize    {} of {}\n{}{}{}", printable_line(folder), info.steps,
                   info.values, byte_size_text(info.bytes), byte_size_text(info.limit),
                   uses_text("size by filter", info.by_filter), uses_text("size by workflow", info.by_workflow),
                   uses_text("size by last use", info.by_age));
    return done;
}

int clear(const Options& options) {
    const u64 removed = open_cache(options.cache, {})->clear();
    if (options.json)
        print_json({{"scanmill", 1}, {"removed", removed}});
    else
        fmt::print("{} removed\n", byte_size_text(removed));
    return done;
}

}  // namespace

void add_cache(CLI::App& app, Action& chosen) {
    CLI::App* command = app.add_subcommand("cache", "Shows the size of the cache of results, or empties it");
    command->require_subcommand(1);
    const auto add = [&](const char* name, const char* help, int (*act)(const Options&)) {
        auto [part, options] = add_command<Options>(*command, chosen, name, help, act);
        add_cache_options(part, options.cache);
        part.add_flag("--json", options.json, "Print the result as JSON");
    };
    add("info", "Prints the folder, the number of results and their size", info);
    add("clear", "Removes all results; they are computed again when they are needed", clear);
}

}  // namespace scanmill::runner
