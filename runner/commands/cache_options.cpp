// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands/cache_options.hpp"

#include <fmt/format.h>

#include <set>

#include "output/error_output.hpp"
#include "output/printable.hpp"
#include "output/stderr_text.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill::runner {

void add_cache_options(CLI::App& command, CacheOptions& options, bool computes) {
    CLI::Option* folder = command.add_option(
        "--cache", options.folder, "The cache's folder; without it $XDG_CACHE_HOME/scanmill, else ~/.cache/scanmill");
    command
        .add_option("--cache-limit", options.limit,
                    "Beyond this size what was used longest ago is removed: 500 MiB, 20 GiB")
        ->default_str(byte_size_text(Cache::default_limit));
    if (!computes) return;
    command.add_flag("--no-cache", options.none, "Compute everything and keep nothing")->excludes(folder);
    command
        .add_option("--keep", options.keep,
                    "Which values the cache keeps: those that are worth it (making them takes more than twice as long "
                    "as writing them), always all, or never any")
        ->capture_default_str()
        ->check(CLI::IsMember({"worth", "always", "never"}));
}

Warn warning_teller() {
    return [told = std::make_shared<std::set<std::string>>()](const std::string& text) {  // all copies know it
        if (told->insert(text).second) tell("warning: {}\n", printable(text));
    };
}

std::unique_ptr<Cache> open_cache(const CacheOptions& options, const Warn& warn) {
    if (options.none) return nullptr;
    const u64 limit = options.limit.empty() ? Cache::default_limit : parse_byte_size(options.limit);
    if (!options.folder.empty()) return std::make_unique<Cache>(std::filesystem::absolute(options.folder), limit, warn);
    try {
        return std::make_unique<Cache>(default_cache_folder(), limit, warn);
    } catch (const Error& error) {
        warn(fmt::format("{}; nothing is kept. {}", error.sentence(), with_option(error).hint()));
        return nullptr;
    }
}

KeepRule::Policy keep_policy(const CacheOptions& options) {
    return options.keep == "always"  ? KeepRule::Policy::always
           : options.keep == "never" ? KeepRule::Policy::never
                                     : KeepRule::Policy::worth;
}

}  // namespace scanmill::runner
