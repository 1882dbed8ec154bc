// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The options that say which cache a command uses.

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>

#include "scanmill/cache/cache.hpp"

namespace scanmill::runner {

struct CacheOptions {
    std::string folder, keep = "worth", limit;
    bool none = false;
};

/// `--cache` and `--cache-limit`; for commands that compute also `--no-cache` and `--keep`.
void add_cache_options(CLI::App& command, CacheOptions& options, bool computes);

using Warn = std::function<void(std::string)>;

/// Tells warnings on stderr, equal sentences once.
Warn warning_teller();

/// Nothing with --no-cache, or, after a warning, when neither an option nor the environment names a folder.
std::unique_ptr<Cache> open_cache(const CacheOptions& options, const Warn& warn);

KeepRule::Policy keep_policy(const CacheOptions& options);

}  // namespace scanmill::runner
