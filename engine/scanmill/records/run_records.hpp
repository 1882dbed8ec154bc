// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The history of runs: one SQLite file per output folder, to which every run appends.
///
/// Rows are never changed, and removed only with their whole run. A run without an end is still running or was killed.
/// The file may be on a network file system, because it uses a rollback journal. Any SQLite program can read it. Its
/// tables derive from the fields of the records (report/run_report.hpp, detail/table.hpp). A version of Scanmill with
/// other fields refuses the file.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/plan/output_names.hpp"
#include "scanmill/report/run_report.hpp"

namespace scanmill {

/// The acceptance of a run as the baseline of its batch.
struct Acceptance {
    std::int64_t id = 0, run = 0;
    std::string batch, at, who, why;
    std::optional<std::string> revoked_at;
    std::string revoked_by, revoked_why;
};

/// Doubts of a cell that a person looked at and knows. They stay known while they are unchanged.
struct Acknowledgement {
    std::string batch, workflow, scan, variant;  ///< the scan's path is relative to the batch's folder
    std::string at, who, why;
    std::vector<std::string> doubts;
};
constexpr auto fields(const Acknowledgement*) {
    using R = Acknowledgement;
    return std::tuple{field("batch", &R::batch), field("workflow", &R::workflow),
                      field("scan", &R::scan),   field("variant", &R::variant),
                      field("at", &R::at),       field("who", &R::who),
                      field("why", &R::why),     field("doubts", &R::doubts)};
}

/// The costs of a cell in earlier runs.
struct PastCosts {
    std::string workflow, scan, variant;
    std::vector<CostRecord> costs;  ///< the oldest first
};

/// A step of an earlier run, for comparison with a step of the next run.
struct PastStep {
    std::int64_t run = 0;
    std::uint64_t seed = 0;
    std::string filter, build, plan_key;
    int filter_version = 0;
    Texts authored;
    bool done = true;  ///< false: the step failed or was skipped
};

/// A file that a run wrote: an output, or a failed result.
struct RecordedFile {
    std::int64_t run = 0;
    std::string path, sha256;
    std::uint64_t bytes = 0;
};

class RunRecords {
public:
    /// Opens the records for appending, or creates them. Throws Error for a file of another layout, for a file that is
    /// not a database, and for an unwritable folder.
    static RunRecords append_to(const std::filesystem::path& file);
    /// Opens records for reading. The functions below that are not const need append_to() instead. Throws Error as
    /// append_to() does.
    static RunRecords read(const std::filesystem::path& file);
    RunRecords(RunRecords&&) noexcept;
    ~RunRecords();

    /// Adds a run and returns its number. `started`: as in RunSummary; empty: now.
    std::int64_t begin(const RunStart& start, const std::string& started = {});
    /// Appends rows in one transaction. Throws Error if the disk is full.
    void add(std::int64_t run, const std::vector<StepRecord>& steps, const std::vector<CellRecord>& cells);
    /// Appends the last rows and the outcome of the run in one transaction.
    void end(std::int64_t run, const std::vector<StepRecord>& steps, const std::vector<CellRecord>& cells,
             const std::string& outcome, double seconds);
    void end(std::int64_t run, const std::string& outcome, double seconds) { end(run, {}, {}, outcome, seconds); }
    /// Appends the costs of one more pass over cells of the run. Pre: this object added the cells.
    void add_costs(std::int64_t run, const std::vector<PastCosts>& cells);
    /// Appends the verdict of the gate on the run: the number of cells that regressed.
    void add_verdict(std::int64_t run, std::size_t regressions);

    /// Makes the run the baseline of its batch. Throws Error for an unknown run, and for a run that was killed or
    /// interrupted.
    void accept(std::int64_t run, const std::string& who, const std::string& why);
    /// Revokes the newest valid acceptance of the batch. The valid acceptance before it then holds again. Throws Error
    /// if the batch has no valid acceptance.
    void revoke(const std::string& batch, const std::string& who, const std::string& why);
    /// The acceptances of all batches, including revoked ones, oldest first.
    std::vector<Acceptance> acceptances() const;
    /// The newest acceptance of this batch that was not revoked.
    std::optional<Acceptance> baseline(const std::string& batch) const;
    /// Records that these doubts of a cell are known; `at` is set to now. Earlier acknowledgements of the cell hold,
    /// too.
    void acknowledge(Acknowledgement acknowledgement);
    /// The acknowledgements of the cells of this batch, oldest first.
    std::vector<Acknowledgement> acknowledgements(const std::string& batch) const;
    /// The costs of cells in earlier runs with numbers `first` <= run < `end`. Considers only runs that have the
    /// workflow, machine, threads and jobs of `like` and that measured costs; of these, the newest `most_past_runs`.
    static constexpr int most_past_runs = 20;
    std::vector<PastCosts> past_costs(const RunStart& like, std::int64_t first, std::int64_t end) const;

    /// The files that the runs wrote, in the order of the runs.
    std::vector<RecordedFile> files() const;
    /// The files that the steps of the run read, as they were named.
    std::vector<std::string> read_files(std::int64_t run) const;
    /// Removes these runs with everything that belongs to them, and gives the space back to the file system. If that
    /// fails, because the disk is full, warns: the next run then uses the space.
    void remove(const std::vector<std::int64_t>& runs, const std::function<void(std::string)>& warn);

    /// All runs in the order of their numbers.
    std::vector<RunSummary> runs() const;
    /// Throws Error for an unknown run. The message contains the numbers of the existing runs.
    RunSummary summary(std::int64_t id) const;
    RunDetails run(std::int64_t id) const;
    /// The steps with this label on this scan, in the newest run of the workflow that has such steps.
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
