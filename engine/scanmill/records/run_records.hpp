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
    std::string gate{};  ///< to_json_text() of the batch's gate; empty: this run is not of a batch, or it has no gate
};

struct FailureRecord {
    std::string cause;  ///< empty: none
    int number = 0;  ///< signal or exit code
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
    std::string measures;  ///< what it measures by the cell's truth, as "surface"; empty: it measures nothing
};

struct OutputRecord {
    std::string file, kind, outcome;
    Metrics properties;
    std::string sha256{};  ///< of the file's bytes; empty: not written
    std::int64_t bytes = 0;  ///< of the file
    std::string moved_to{};  ///< where the file of an earlier run was moved when this cell failed; empty: nowhere
};

/// What one pass over a cell cost, all of whose steps ran in it.
struct CostRecord {
    double seconds = 0, cpu_seconds = 0;  ///< sums over its steps
    std::int64_t peak_memory = 0;  ///< bytes, the largest of its steps
};

struct CellRecord {
    std::string workflow, scan, variant, outcome;
    FailureRecord failure;
    double seconds = 0;
    std::vector<std::size_t> nodes;  ///< of the run's graph; their steps were recorded before
    std::vector<OutputRecord> outputs;
    std::vector<std::string> doubts;
    std::string truth{};  ///< the file; empty: none
    std::vector<CostRecord> costs{};  ///< one per pass; empty if a step came from the cache or failed
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

/// A run was accepted as the baseline of its batch.
struct Acceptance {
    std::int64_t id = 0, run = 0;
    std::string at, who, why;
    std::optional<std::string> revoked_at;
    std::string revoked_by, revoked_why;
};

/// What a cell of earlier runs cost.
struct PastCosts {
    std::string workflow, scan, variant;
    std::vector<CostRecord> costs;  ///< the oldest first
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
    /// Opens records for reading; tables of an older version are migrated first, in memory if the file cannot be
    /// written. Of the functions below, those that are not const need append_to().
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
    /// Appends the costs of one more pass over cells of the run. Pre: this object added the cells.
    void add_costs(std::int64_t run, const std::vector<PastCosts>& cells);

    /// Makes the run the baseline of its batch. Throws Error for an unknown run and one that was killed or interrupted.
    void accept(std::int64_t run, const std::string& who, const std::string& why);
    /// Revokes the newest valid acceptance of the batch, so that the one before it holds again. Throws Error if there
    /// is none.
    void revoke(const std::string& batch, const std::string& who, const std::string& why);
    /// Of all batches, with revoked ones, in the order in which they were made.
    std::vector<Acceptance> acceptances() const;
    /// The run that was accepted last for this batch, and not revoked.
    std::optional<Acceptance> baseline(const std::string& batch) const;
    /// The costs of the batch's cells in the runs `first` <= run < `end` on this machine with so many threads and jobs;
    /// of the newest `most_past_runs` of those that measured any.
    static constexpr int most_past_runs = 20;
    std::vector<PastCosts> past_costs(const RunStart& like, std::int64_t first, std::int64_t end) const;

    /// In the order of their numbers.
    std::vector<RunSummary> runs() const;
    /// Throws Error for an unknown run, naming the existing ones.
    RunSummary summary(std::int64_t id) const;
    RunDetails run(std::int64_t id) const;
    /// The steps with this label on this scan in the newest run of the workflow that has any.
    std::vector<PastStep> last_steps(const std::string& workflow, const std::string& scan,
                                     const std::string& label) const;

private:
    struct Database;
    static std::unique_ptr<Database> open_to_read(const std::filesystem::path& file);
    std::string now() const;
    std::vector<RunSummary> summaries(std::optional<std::int64_t> id) const;
    std::vector<Acceptance> acceptances(const std::string& condition, const std::string& key) const;
    void insert(std::int64_t run, const std::vector<StepRecord>& steps, const std::vector<CellRecord>& cells);
    explicit RunRecords(std::unique_ptr<Database> database);
    std::unique_ptr<Database> database_;
};

}  // namespace scanmill
