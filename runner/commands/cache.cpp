// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands/cache_options.hpp"
#include "commands/commands.hpp"
#include "output/printable.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill::runner {

namespace {

using Json = nlohmann::ordered_json;

Cache open_named(const CacheOptions& options) {
    const u64 limit = options.limit.empty() ? Cache::default_limit : parse_byte_size(options.limit);
    return Cache(options.folder.empty() ? default_cache_folder() : std::filesystem::path(options.folder), limit);
}

int info(const CacheOptions& options, bool json) {
    const CacheInfo info = open_named(options).info();
    if (json) {
        const Json described{{"scanmill", 1},       {"folder", info.folder.string()},
                             {"steps", info.steps}, {"values", info.values},
                             {"bytes", info.bytes}, {"limit", info.limit}};
        fmt::print("{}\n", described.dump(2, ' ', false, Json::error_handler_t::replace));
        return done;
    }
    fmt::print("folder  {}\nsteps   {}\nvalues  {}\nsize    {} of {}\n", printable_line(info.folder.string()),
               info.steps, info.values, byte_size_text(info.bytes), byte_size_text(info.limit));
    return done;
}

int clear(const CacheOptions& options, bool json) {
    const u64 removed = open_named(options).clear();
    if (json)
        fmt::print("{}\n", Json{{"scanmill", 1}, {"removed", removed}}.dump(2));
    else
        fmt::print("{} removed\n", byte_size_text(removed));
    return done;
}

}  // namespace

void add_cache(CLI::App& app, Action& chosen) {
    struct Options {
        CacheOptions cache;
        bool json = false;
    };
    CLI::App* command = app.add_subcommand("cache", "Says how large the cache of results is, or empties it");
    command->require_subcommand(1);
    const auto add = [&](const char* name, const char* help, int (*act)(const CacheOptions&, bool)) {
        auto options = std::make_shared<Options>();
        CLI::App* part = command->add_subcommand(name, help);
        add_cache_options(*part, options->cache, false);
        part->add_flag("--json", options->json, "Print it as JSON");
        part->callback(
            [&chosen, options, act] { chosen = [options, act] { return act(options->cache, options->json); }; });
    };
    add("info", "Prints the folder, how many results it holds, and their size", info);
    add("clear", "Removes all results; they are computed again when they are needed", clear);
}

}  // namespace scanmill::runner
