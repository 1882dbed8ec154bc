// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The history of runs: one SQLite file per output folder, to which every run appends.
///
/// Rows are never changed or removed. A run without an end was killed. The file may be on a network file system
/// (rollback journal), and any SQLite program can read it; its tables are in run_records.cpp. NaN is stored as NULL.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/data/metrics.hpp"

namespace scanmill {

struct RunStart {
    std::string workflow, file;  ///< name and file of the workflow or the batch
    std::vector<std::string> arguments;  ///< of the command
    std::uint64_t seed = 0;
    unsigned threads = 1;  ///< inside a filter
    unsigned jobs = 0;     ///< worker processes; 0: none
    std::string version, machine, libraries;
};

struct FailureRecord {
    std::string cause;  ///< empty: none
    int number = 0;      ///< signal or exit code
    std::string error;  ///< whole text with frames and hint
};

struct StepRecord {
    std::size_t node = 0;  ///< index into the run's graph
    std::string workflow, label, filter, scan, plan_key, build;
    int filter_version = 0;
    std::string origin, why, outcome;
    FailureRecord failure;
    double seconds = 0, cpu_seconds = 0;
    std::int64_t peak_memory = 0;  ///< bytes; 0: not known
    unsigned threads = 0, attempts = 0;
    std::vector<std::string> log;  ///< the last lines that it wrote to standard output and error
    std::vector<std::pair<std::string, std::string>> authored, resolved;  ///< parameters, as text
    Metrics metrics, properties;
    std::vector<std::string> warnings;
};

struct OutputRecord {
    std::string file, kind, outcome;
    Metrics properties;
};

struct CellRecord {
    std::string workflow, scan, variant, outcome;
    FailureRecord failure;
    double seconds = 0;
    std::vector<std::size_t> nodes;  ///< of the run's graph; their steps were recorded before
    std::vector<OutputRecord> outputs;
    std::vector<std::string> doubts;
};

struct RunSummary {
    std::int64_t id = 0;
    std::string started, workflow;
    std::optional<std::string> outcome;  ///< nothing: the run was killed
    std::size_t cells = 0, doubtful = 0, failed = 0, ran = 0, cached = 0;
    double seconds = 0;
};

struct RunDetails {
    RunSummary summary;
    RunStart start;
    std::vector<CellRecord> cells;
    std::vector<StepRecord> steps;
};

/// A step of an earlier run, for comparison with the next.
struct PastStep {
    std::int64_t run = 0;
    std::uint64_t seed = 0;
    std::string filter, build, plan_key;
    int filter_version = 0;
    std::vector<std::pair<std::string, std::string>> authored;
    bool done = true;
};

/// The file's name in an output folder.
inline constexpr const char* records_file = "scanmill.sqlite";

class RunRecords {
public:
    /// Opens the records for appending, or creates them. Throws Error: not such a file, one of a newer Scanmill, or an
    /// unwritable folder.
    static RunRecords append_to(const std::filesystem::path& file);
    /// Opens records for reading; tables of an older version are migrated first.
    static RunRecords read(const std::filesystem::path& file);
    RunRecords(RunRecords&&) noexcept;
    ~RunRecords();

    /// The new run's number.
    std::int64_t begin(const RunStart& start);
    /// Appends rows in one transaction. Throws Error if the disk is full.
    void add(std::int64_t run, const std::vector<StepRecord>& steps, const std::vector<CellRecord>& cells);
    /// Appends the last rows and the outcome of the run in one transaction.
    void end(std::int64_t run, const std::vector<StepRecord>& steps, const std::vector<CellRecord>& cells,
             const std::string& outcome, double seconds);
    void end(std::int64_t run, const std::string& outcome, double seconds) { end(run, {}, {}, outcome, seconds); }

    /// In the order of their numbers.
    std::vector<RunSummary> runs() const;
    /// Throws Error for an unknown run, naming the existing ones.
    RunDetails run(std::int64_t id) const;
    /// The steps with this label on this scan in the newest run of the workflow that has any.
    std::vector<PastStep> last_steps(const std::string& workflow, const std::string& scan,
                                     const std::string& label) const;

private:
    struct Database;
    void insert(std::int64_t run, const std::vector<StepRecord>& steps, const std::vector<CellRecord>& cells);
    explicit RunRecords(std::unique_ptr<Database> database);
    std::unique_ptr<Database> database_;
};

}  // namespace scanmill
