// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The environment of a running filter: an Execution with warnings, doubts, metrics, random numbers and a scratch
/// folder. A C++ program that calls an algorithm directly creates a `Context context;`.

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/data/metrics.hpp"
#include "scanmill/record/fields.hpp"

namespace scanmill {

struct ContextOptions : ExecutionOptions {
    std::uint64_t seed = 0;
    /// A folder that exists while the algorithm runs; empty if there is none.
    std::filesystem::path scratch;
    /// Called from any thread, one call at a time.
    std::function<void(std::string_view text)> on_warning;
};

struct Doubt {
    std::string text;
    std::string port;  ///< the output that the text is about; empty for all outputs
};
constexpr auto fields(const Doubt*) {
    using R = Doubt;
    return std::tuple{field("text", &R::text), field("port", &R::port)};
}

class Context : public Execution {
public:
    explicit Context(ContextOptions options = {});

    /// Reports one sentence about a valid but remarkable result; callable from any thread. After most_warnings
    /// sentences, a last one reports that there were more.
    void warn(std::string text);
    /// Reports one sentence on why the result is probably not what the user wants. The cells that use the result end
    /// as doubtful. `port` is the output that the doubt is about; empty means all outputs. Callable from any thread.
    void doubt(std::string text, std::string port = {});
    void metric(std::string_view name, double value, Unit unit = Unit::count);
    /// A generator with this run's seed. Every call returns the same state; derive others with stream().
    Random random() const { return Random(seed_); }
    const std::filesystem::path& scratch() const { return scratch_; }

    static constexpr std::size_t most_warnings = 1000;

    const Metrics& metrics() const { return metrics_; }
    const std::vector<std::string>& warnings() const { return warnings_; }
    const std::vector<Doubt>& doubts() const { return doubts_; }

private:
    std::uint64_t seed_;
    std::filesystem::path scratch_;
    std::function<void(std::string_view)> on_warning_;
    Metrics metrics_;
    std::vector<std::string> warnings_;
    std::vector<Doubt> doubts_;
};

}  // namespace scanmill
