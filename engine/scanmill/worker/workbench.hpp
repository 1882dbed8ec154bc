// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Does jobs one after the other: reads files, runs filters, writes results. Keeps their values for later jobs.

#include <chrono>
#include <functional>
#include <map>
#include <optional>

#include "scanmill/cache/cache.hpp"
#include "scanmill/worker/job.hpp"
#include "scanmill/worker/open_scans.hpp"
#include "scanmill/worker/step_runner.hpp"

namespace scanmill {

/// Receives events of a job; from any thread, one call at a time.
struct JobListener {
    std::function<void(double fraction)> on_progress;
    std::function<void(std::string_view text)> on_warning;
    std::function<bool()> is_cancelled;
    /// Called before a module is loaded, with its file, and after, with an empty text.
    std::function<void(std::string module)> on_loading = {};
};

class Workbench {
public:
    /// Library and cache must outlive it; `cache` may be null. `scratch`: a folder whose content this may remove.
    Workbench(FilterLibrary& library, Cache* cache, KeepRule::Policy policy, std::filesystem::path scratch);

    /// Does not throw: failures are in the report. Enforces the limit of memory, but not that of time.
    JobReport perform(const Job& job, const JobListener& listener);
    /// Drops the node's values.
    void forget(std::size_t node) {
        values_.erase(node);
        scans_.forget(node);
        std::erase_if(properties_, [&](const auto& properties) { return properties.first.first == node; });
    }
    bool is_empty() const { return values_.empty() && scans_.empty(); }

private:
    using Slot = std::pair<std::size_t, std::string>;  // node and port

    void read(const Job& job, const ReadWork& work, const JobListener& listener, JobReport& report);
    bool read_as_stream(const Job& job, const ReadWork& work, const JobListener& listener, const OnWarning& on_warning,
                        const std::function<void()>& report_warnings, JobReport& report);
    void run(const Job& job, const StepWork& work, const JobListener& listener, JobReport& report);
    void write(const WriteWork& work, JobReport& report);
    void check_expectations(const PlannedStep& step, const Value& primary, const Slot& slot, NodeReport& report);

    const Value* find(std::size_t node, const std::string& port) const;
    /// From memory, the cache, or its file. Throws InputLost, and adds it to the report, if it is nowhere.
    Value fetch(const JobInput& input, JobReport& report);
    /// The step's scan, if it can be streamed. The cache is not asked for its value: whether a scan fits into memory
    /// must not depend on earlier runs.
    std::shared_ptr<const PointStream> stream_for(const StepWork& work, unsigned threads);

    bool uses_cache(const JobCaching& caching) const { return cache_ && caching.is_used; }
    std::optional<Outputs> recalled(const StepWork& work, const std::string& run_key, const JobListener& listener,
                                    JobReport& report) const;
    void add_kept(JobReport& report) const;
    void store(const Job& job, const JobCaching& caching, const std::string& run_key, const std::string& path_prefix,
               double seconds, JobReport& report);
    void store_values(const Job& job, const JobCaching& caching, double cost, JobReport& report);

    FilterLibrary& library_;
    Cache* cache_;
    KeepRule rule_;
    std::filesystem::path scratch_, folder_;
    std::map<std::size_t, std::vector<StepInput>> values_;  // by node
    OpenScans scans_;
    std::map<Slot, Metrics> properties_;  // of values, if they were computed
};

inline double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Copies a cached result into the report of a node. `path_prefix` is put before warnings of reading a file.
void adopt(const StepResult& result, const PlannedStep* step, const std::string& path_prefix, NodeReport& report);

/// The beginning of warnings about reading this file.
std::string path_prefix(const std::filesystem::path& file);

}  // namespace scanmill
