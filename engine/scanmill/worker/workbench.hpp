// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Does jobs one after the other: reads files, runs filters, writes results. Between jobs it keeps only the scan that
/// was opened last.

#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "scanmill/cache/cache.hpp"
#include "scanmill/cache/run_values.hpp"
#include "scanmill/data/point_stream.hpp"
#include "scanmill/worker/job.hpp"
#include "scanmill/worker/step_runner.hpp"
#include "scanmill/worker/unchanged_file.hpp"

namespace scanmill {

class CountedWarnings;

/// Receives events of a job. Calls come from any thread, one at a time.
struct JobListener {
    std::function<void(double fraction)> on_progress;
    std::function<void(std::string_view text)> on_warning;
    std::function<bool()> is_cancelled;
    /// Called with the module's file before a module is loaded, and with an empty text afterwards.
    std::function<void(std::string module)> on_loading = {};
};

class Workbench {
public:
    /// `library`, `cache` and `values` must outlive the workbench. `cache` may be null. The workbench may remove the
    /// content of the folder `scratch`.
    Workbench(FilterLibrary& library, Cache* cache, KeepRule::Policy policy, RunValues& values,
              std::filesystem::path scratch);

    /// Does a job. Does not throw: the report contains failures. Enforces the memory limit, but not the time limit.
    /// Afterwards, values that other tasks need are in the cache or in the RunValues.
    JobReport perform(const Job& job, const JobListener& listener);

private:
    struct OpenScan {
        std::size_t node;
        std::shared_ptr<const PointStream> stream;
        std::optional<UnchangedWhileRead> check;
    };

    void read(const Job& job, const ReadWork& work, const JobListener& listener, JobReport& report);
    bool read_as_stream(const Job& job, const ReadWork& work, const JobListener& listener, CountedWarnings& warnings,
                        const std::function<void()>& report_warnings, JobReport& report);
    void run(const Job& job, const StepWork& work, const JobListener& listener, JobReport& report);
    void write(const WriteWork& work, JobReport& report);

    /// Takes the value from the RunValues, the cache or its file. If none of them has it, adds it to JobReport::lost
    /// and throws InputLost.
    Value fetch(const JobInput& input, JobReport& report) const;
    /// The step's scan as a stream; nullptr if it cannot be streamed. A value of the scan in the cache is not used:
    /// whether a scan fits into memory must not depend on earlier runs.
    std::shared_ptr<const PointStream> stream_for(const StepWork& work, unsigned threads);
    /// Opens the file as a stream; nullptr if it cannot be streamed. With `is_checked`, requires that the file did not
    /// change since planning.
    std::shared_ptr<const PointStream> open(std::size_t node, const LeafSource& leaf, unsigned threads, bool is_checked,
                                            const OnWarning& on_warning, const OnWorldPositions& on_positions = {});

    bool uses_cache(const JobCaching& caching) const { return cache_ && caching.is_used; }
    std::optional<Outputs> recalled(const StepWork& work, const std::string& run_key, const JobListener& listener,
                                    JobReport& report) const;
    void add_kept(JobReport& report) const;
    void store(const Job& job, const JobCaching& caching, const std::string& run_key, const Outputs& outputs,
               std::vector<std::string> warnings, double seconds, JobReport& report);
    void store_values(const Job& job, const JobCaching& caching, const Outputs& outputs, double cost,
                      JobReport& report);

    FilterLibrary& library_;
    Cache* cache_;
    KeepRule rule_;
    RunValues& values_;
    std::filesystem::path scratch_, folder_;
    std::optional<OpenScan> scan_;
};

inline double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Copies a cached result into the report of a node. Cached warnings about reading do not name the file, because files
/// with equal content share the result.
void adopt(const StepResult& result, const PlannedStep* step, NodeReport& report);

/// The warnings with the name of the file before each.
std::vector<std::string> warnings_about(const std::filesystem::path& file, std::vector<std::string> warnings);

}  // namespace scanmill
