// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a running algorithm may ask of its surroundings: report, be cancelled, draw random numbers, use threads and a
/// scratch folder. There are no globals; a C++ program that calls an algorithm directly makes a `Context context;`.

#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "scanmill/data/metrics.hpp"
#include "scanmill/filter/random.hpp"

namespace scanmill {

/// Thrown by check_cancelled(); passes through algorithms untouched.
struct __attribute__((visibility("default"))) Cancelled {};

struct ContextOptions {
    /// At least 1. Results never depend on it.
    unsigned threads = 1;
    std::uint64_t seed = 0;
    /// Exists while the algorithm runs; empty: none was given.
    std::filesystem::path scratch;
    /// Called from any thread, one call at a time.
    std::function<void(double fraction)> on_progress;
    std::function<void(std::string_view text)> on_warning;
    std::function<bool()> is_cancelled;
};

class Context {
public:
    explicit Context(ContextOptions options = {});

    /// `fraction` in [0, 1]; callable from any thread.
    void progress(double fraction);
    bool cancelled() const;
    /// Throws Cancelled when somebody asked to stop. Cheap enough for every chunk of work.
    void check_cancelled() const;
    /// One sentence about something the user should know although the result stands; callable from any thread. After
    /// most_warnings of them only that there were more is kept.
    void warn(std::string text);
    void metric(std::string_view name, double value, Unit unit = Unit::count);
    /// A generator for this run's seed; every call returns the same state, so split it with stream().
    Random random() const { return Random(options_.seed); }
    unsigned threads() const { return options_.threads; }
    const std::filesystem::path& scratch() const { return options_.scratch; }

    static constexpr std::size_t most_warnings = 1000;

    const Metrics& metrics() const { return metrics_; }
    const std::vector<std::string>& warnings() const { return warnings_; }

private:
    ContextOptions options_;
    mutable std::mutex mutex_;
    Metrics metrics_;
    std::vector<std::string> warnings_;
};

}  // namespace scanmill
