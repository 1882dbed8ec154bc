// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Where jobs are done, one after the other: files read, filters run, results written. Values stay on the bench until
/// they are forgotten, so that the next job need not fetch them.

#include <chrono>
#include <functional>
#include <map>
#include <optional>

#include "scanmill/cache/cache.hpp"
#include "scanmill/cache/keep_rule.hpp"
#include "scanmill/plugin/library.hpp"
#include "scanmill/worker/job.hpp"
#include "scanmill/worker/open_scans.hpp"
#include "scanmill/worker/step_runner.hpp"

namespace scanmill {

/// What is told while a job is done; from any thread, one call at a time.
struct JobListener {
    std::function<void(double fraction)> on_progress;
    std::function<void(std::string_view text)> on_warning;
    std::function<bool()> is_cancelled;
};

class Workbench {
public:
    /// All must outlive it. Without a cache nothing is taken from one and nothing kept. `scratch`: a folder whose
    /// content this may remove.
    Workbench(FilterLibrary& library, Cache* cache, KeepRule::Policy policy, std::filesystem::path scratch);

    /// Never throws: whatever goes wrong is in the report. Limits are for the surroundings to enforce.
    JobReport perform(const Job& job, const JobListener& listener);
    /// Drops the node's values.
    void forget(std::size_t node) {
        values_.erase(node);
        scans_.forget(node);
        std::erase_if(properties_, [&](const auto& properties) { return properties.first.first == node; });
    }
    bool is_empty() const { return values_.empty() && scans_.empty(); }

private:
    using Place = std::pair<std::size_t, std::string>;  // node and port

    void run(const Job& job, const StepWork& work, const JobListener& listener, JobReport& report);
    void expect(const Job& job, const ExpectWork& work, JobReport& report);
    void check_expectations(const PlannedStep& step, const Value& primary, const Place& place, NodeReport& report);
    void write(const Job& job, const WriteWork& work, JobReport& report);
    bool uses_cache(const JobMemory& memory) const { return cache_ && memory.is_used; }

    // workbench_inputs.cpp
    void read(const Job& job, const ReadWork& work, const JobListener& listener, JobReport& report);
    bool read_as_stream(const Job& job, const ReadWork& work, const JobListener& listener,
                        const std::function<void(std::string)>& on_warning, JobReport& report);
    const Value* find(std::size_t node, const std::string& port) const;
    /// From the bench or the cache.
    std::optional<Value> at_hand(const JobInput& input);
    /// The step's scan, when it is to be had as a stream. Its value is not looked for in the cache: whether a scan fits
    /// into memory must not depend on what was done before.
    std::shared_ptr<const PointStream> stream_for(const StepWork& work, unsigned threads);
    /// From the bench, the cache, or its file; nothing, and a word in the report, when it is lost.
    std::optional<Value> fetch(const JobInput& input, JobReport& report);

    // workbench_memory.cpp
    std::optional<Outputs> recalled(const StepWork& work, const std::string& run_key, const JobListener& listener,
                                    JobReport& report) const;
    void remember(const Job& job, const JobMemory& memory, const std::string& run_key, const std::string& path_prefix,
                  double seconds, JobReport& report);
    void keep_values(std::size_t node, const JobMemory& memory, double cost, JobReport& report);

    FilterLibrary& library_;
    Cache* cache_;
    KeepRule rule_;
    std::filesystem::path scratch_, folder_;
    std::map<std::size_t, std::vector<StepInput>> values_;  // by node
    OpenScans scans_;
    std::map<Place, Metrics> properties_;  // of values, where they were asked for
};

/// On a clock that only goes forward.
inline double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// What `step` remembers of a result, in the words of this node: warnings of reading begin with `path_prefix`.
void adopt(const StepResult& result, const PlannedStep* step, const std::string& path_prefix, NodeReport& report);

/// How warnings of reading this file begin.
std::string path_prefix(const std::filesystem::path& file);

}  // namespace scanmill
