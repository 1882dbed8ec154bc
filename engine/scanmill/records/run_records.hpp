// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The history of runs: one SQLite file per output folder, to which every run appends.
///
/// Rows are never changed or removed. A run without an end was killed. The file may be on a network file system
/// (rollback journal), and any SQLite program can read it. Its tables follow from the fields of the records
/// (report/run_report.hpp, detail/table.hpp), so a Scanmill with other fields has another layout, and refuses the file.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/report/run_report.hpp"

namespace scanmill {

/// A run was accepted as the baseline of its batch.
struct Acceptance {
    std::int64_t id = 0, run = 0;
    std::string batch, at, who, why;
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
    Texts authored;
    bool done = true;
};

/// The file's name in an output folder.
inline constexpr const char* records_file = "scanmill.sqlite";

class RunRecords {
public:
    /// Opens the records for appending, or creates them. Throws Error for a file of another layout, one that is not a
    /// database, and an unwritable folder.
    static RunRecords append_to(const std::filesystem::path& file);
    /// Opens records for reading. Functions below that are not const need append_to(). Throws Error as append_to()
    /// does.
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
    /// The acceptances of all batches, including revoked ones, oldest first.
    std::vector<Acceptance> acceptances() const;
    /// The run that was accepted last for this batch, and not revoked.
    std::optional<Acceptance> baseline(const std::string& batch) const;
    /// The costs of the batch's cells in the runs `first` <= run < `end` on this machine with so many threads and jobs;
    /// of the newest `most_past_runs` of those that measured any.
    static constexpr int most_past_runs = 20;
    std::vector<PastCosts> past_costs(const RunStart& like, std::int64_t first, std::int64_t end) const;

    /// All runs in the order of their numbers.
    std::vector<RunSummary> runs() const;
    /// Throws Error for an unknown run, naming the existing ones.
    RunSummary summary(std::int64_t id) const;
    RunDetails run(std::int64_t id) const;
    /// The steps with this label on this scan in the newest run of the workflow that has any.
    std::vector<PastStep> last_steps(const std::string& workflow, const std::string& scan,
                                     const std::string& label) const;

private:
    struct Database;
    std::string now() const;
    std::vector<RunSummary> summaries(std::optional<std::int64_t> id) const;
    void insert(std::int64_t run, const std::vector<StepRecord>& steps, const std::vector<CellRecord>& cells);
    explicit RunRecords(std::unique_ptr<Database> database);
    std::unique_ptr<Database> database_;
};

}  // namespace scanmill
