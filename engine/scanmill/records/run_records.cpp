// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/records/run_records.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "scanmill/base/error.hpp"
#include "scanmill/base/hash.hpp"
#include "scanmill/records/detail/table.hpp"

namespace scanmill {

namespace {

using tables::RowId;

/// Runs `action`. Converts exceptions of SQLite to Errors that name the file.
template <class Action>
auto about(const std::string& file, Action&& action) {
    try {
        return action();
    } catch (const SQLite::Exception& error) {
        throw Error("the records '{}': {}", file, error.what());
    }
}

/// The end of a run, with the final counts. A node whose cached value was lost has two rows in `step`; it counts once,
/// as a step that ran.
struct RunEnd {
    std::string ended, outcome;
    double seconds = 0;
    std::size_t cells = 0, doubtful = 0, failed = 0, ran = 0, cached = 0;
};
constexpr auto fields(const RunEnd*) {
    using R = RunEnd;
    return std::tuple{field("ended", &R::ended), field("outcome", &R::outcome),   field("seconds", &R::seconds),
                      field("cells", &R::cells), field("doubtful", &R::doubtful), field("failed", &R::failed),
                      field("ran", &R::ran),     field("cached", &R::cached)};
}

/// The first row of a run.
struct RunRow {
    std::string started;
    RunStart start;
};
constexpr auto fields(const RunRow*) {
    return std::tuple{field("started", &RunRow::started), field("start", &RunRow::start).flat()};
}

/// An acceptance of a run or the revocation of an acceptance: time, person and reason.
struct Decision {
    std::string at, who, why;
};
constexpr auto fields(const Decision*) {
    using R = Decision;
    return std::tuple{field("at", &R::at), field("who", &R::who), field("why", &R::why)};
}

/// The verdict of a batch's gate on a run.
struct GateVerdict {
    std::size_t regressions = 0;
};
constexpr auto fields(const GateVerdict*) { return std::tuple{field("regressions", &GateVerdict::regressions)}; }
constexpr const char* verdict_table = "gate_verdict";
constexpr const char* acknowledgement_table = "acknowledgement";

const std::string& layout() {
    static const std::string sql =
        tables::creation<RunRow>("run", "") + tables::creation<RunEnd>("run_end", "run") +
        tables::creation<StepRecord>("step", "run") + tables::creation<CellRecord>("cell", "run") +
        tables::creation<Decision>("acceptance", "run") + tables::creation<Decision>("revocation", "acceptance") +
        tables::creation<GateVerdict>(verdict_table, "run") +
        tables::creation<Acknowledgement>(acknowledgement_table, "") +
        R"(CREATE INDEX step_by_name ON step (step, scan, parent);
CREATE INDEX step_by_node ON step (parent, node, origin);
CREATE VIEW run_counts AS SELECT run.id AS run,
    COALESCE(run_end.cells, (SELECT COUNT(*) FROM cell WHERE parent = run.id)) AS cells,
    COALESCE(run_end.doubtful, (SELECT COUNT(*) FROM cell WHERE parent = run.id AND outcome = 'doubtful')) AS doubtful,
    COALESCE(run_end.failed, (SELECT COUNT(*) FROM cell WHERE parent = run.id AND outcome = 'failed')) AS failed,
    COALESCE(run_end.ran, (SELECT COUNT(DISTINCT node) FROM step WHERE parent = run.id AND origin = 'ran')) AS ran,
    COALESCE(run_end.cached, (SELECT COUNT(DISTINCT node) - COUNT(DISTINCT CASE origin WHEN 'ran' THEN node END)
        FROM step WHERE parent = run.id)) AS cached
    FROM run LEFT JOIN run_end ON run_end.parent = run.id;
)";
    return sql;
}

/// A positive number of at most 31 bits that identifies the layout.
int layout_number() {
    static const int number = [] {
        KeyBuilder key;
        key.field("layout", layout());
        return std::stoi(key.key().substr(0, 7), nullptr, 16) + 1;
    }();
    return number;
}

}  // namespace

struct RunRecords::Database {
    Database(const std::filesystem::path& path, int flags)
        : file(path.string()),
          sqlite(file, flags, patience),
          statements(sqlite) {}

    int number() { return sqlite.execAndGet("PRAGMA user_version").getInt(); }
    void create_if_empty() {
        if (number() == layout_number()) return;
        SQLite::Transaction transaction(sqlite, SQLite::TransactionBehavior::IMMEDIATE);
        if (number() == 0 && sqlite.execAndGet("SELECT COUNT(*) FROM sqlite_master").getInt() == 0) {
            sqlite.exec(layout());
            sqlite.exec(fmt::format("PRAGMA user_version = {}", layout_number()));
            transaction.commit();
        }
        require_layout();
    }
    void require_layout() {
        if (number() == layout_number()) return;
        const std::string writer = last_version();
        throw Error("the records '{}' have another layout than this version of Scanmill writes{}", file,
                    writer.empty() ? "" : "; Scanmill " + writer + " wrote them last")
            .hint("use the Scanmill that wrote them, or move the file away to start a new history");
    }
    /// The version of the program that wrote the last run; empty if the file, of any layout, does not say it.
    std::string last_version() {
        try {
            return sqlite.execAndGet("SELECT version FROM run ORDER BY id DESC LIMIT 1").getString();
        } catch (const SQLite::Exception&) {
            return {};
        }
    }

    static constexpr int patience = 1000;  // milliseconds to wait while another run writes
    std::string file;
    SQLite::Database sqlite;
    tables::Statements statements;
    std::map<std::tuple<RowId, std::string, std::string, std::string>, RowId>
        cell_ids;  // by run, workflow, scan and variant
};

RunRecords::RunRecords(std::unique_ptr<Database> database) : database_(std::move(database)) {}
RunRecords::RunRecords(RunRecords&&) noexcept = default;
RunRecords::~RunRecords() = default;

/// Throws Error if `file` is a symbolic link out of its folder, because runs write only into their output folder.
static void require_in_its_folder(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::is_symlink(file, ignored)) return;
    const std::filesystem::path folder = std::filesystem::weakly_canonical(file.parent_path(), ignored);
    const std::filesystem::path target =
        std::filesystem::weakly_canonical(folder / std::filesystem::read_symlink(file, ignored), ignored);
    if (target.parent_path() != folder)
        throw Error("'{}' is a symbolic link to '{}', outside the output folder", file.string(), target.string())
            .hint("remove the link, or choose another output folder");
}

RunRecords RunRecords::append_to(const std::filesystem::path& file) {
    require_in_its_folder(file);
    return about(file.string(), [&] {
        auto database = std::make_unique<Database>(file, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
        database->create_if_empty();
        return RunRecords(std::move(database));
    });
}

RunRecords RunRecords::read(const std::filesystem::path& file) {
    return about(file.string(), [&] {
        if (!std::filesystem::exists(file))
            throw Error("the file '{}' does not exist", file.string()).hint("name the output folder of a run");
        auto database = std::make_unique<Database>(file, SQLite::OPEN_READONLY);
        try {
            database->number();
        } catch (const SQLite::Exception& error) {
            if (error.getErrorCode() != SQLITE_READONLY) throw;
            // A killed run left the journal of an unfinished transaction, which only a writer can roll back.
            database = std::make_unique<Database>(file, SQLite::OPEN_READWRITE);
        }
        if (database->number() == 0) throw Error("'{}' contains no run records", file.string());
        database->require_layout();
        return RunRecords(std::move(database));
    });
}

std::string RunRecords::now() const {
    return database_->sqlite.execAndGet("SELECT strftime('%Y-%m-%dT%H:%M:%SZ', 'now')").getString();
}

std::int64_t RunRecords::begin(const RunStart& start, const std::string& started) {
    return about(database_->file, [&] {
        SQLite::Transaction transaction(database_->sqlite);
        const RowId run =
            tables::insert(database_->statements, "run", RunRow{started.empty() ? now() : started, start});
        transaction.commit();
        return run;
    });
}

void RunRecords::add(std::int64_t run, const std::vector<StepRecord>& steps, const std::vector<CellRecord>& cells) {
    about(database_->file, [&] {
        SQLite::Transaction transaction(database_->sqlite);
        insert(run, steps, cells);
        transaction.commit();
    });
}

void RunRecords::insert(std::int64_t run, const std::vector<StepRecord>& steps, const std::vector<CellRecord>& cells) {
    for (const StepRecord& step : steps) tables::insert(database_->statements, "step", step, run);
    for (const CellRecord& cell : cells)
        database_->cell_ids[{run, cell.workflow, cell.scan, cell.variant}] =
            tables::insert(database_->statements, "cell", cell, run);
}

void RunRecords::end(std::int64_t run, const std::vector<StepRecord>& steps, const std::vector<CellRecord>& cells,
                     const std::string& outcome, double seconds) {
    about(database_->file, [&] {
        SQLite::Transaction transaction(database_->sqlite);
        insert(run, steps, cells);
        RunEnd end{now(), outcome, seconds};
        SQLite::Statement counts(database_->sqlite,
                                 "SELECT cells, doubtful, failed, ran, cached FROM run_counts WHERE run = ?");
        counts.bind(1, run);
        int column = 0;
        if (counts.executeStep())
            for (std::size_t* count : {&end.cells, &end.doubtful, &end.failed, &end.ran, &end.cached})
                *count = static_cast<std::size_t>(counts.getColumn(column++).getInt64());
        tables::insert(database_->statements, "run_end", end, run);
        transaction.commit();
    });
}

void RunRecords::add_costs(std::int64_t run, const std::vector<PastCosts>& cells) {
    about(database_->file, [&] {
        SQLite::Transaction transaction(database_->sqlite);
        for (const PastCosts& cell : cells)
            for (const CostRecord& cost : cell.costs)
                tables::insert(database_->statements, "cell_costs", cost,
                               database_->cell_ids.at({run, cell.workflow, cell.scan, cell.variant}));
        transaction.commit();
    });
}

void RunRecords::add_verdict(std::int64_t run, std::size_t regressions) {
    about(database_->file, [&] {
        SQLite::Transaction transaction(database_->sqlite, SQLite::TransactionBehavior::IMMEDIATE);
        tables::insert(database_->statements, verdict_table, GateVerdict{regressions}, run);
        transaction.commit();
    });
}

std::vector<RunSummary> RunRecords::summaries(std::optional<std::int64_t> id) const {
    return about(database_->file, [&] {
        const std::string sql =
            "SELECT run.id, started, workflow, run_end.outcome, counts.cells, counts.doubtful, counts.failed, "
            "(SELECT verdict.regressions FROM gate_verdict AS verdict WHERE verdict.parent = run.id "
            "ORDER BY verdict.id DESC LIMIT 1), counts.ran, counts.cached, COALESCE(run_end.seconds, 0) FROM run LEFT "
            "JOIN run_end ON "
            "run_end.parent = run.id JOIN run_counts AS counts ON counts.run = run.id";
        SQLite::Statement rows(database_->sqlite, sql + (id ? " WHERE run.id = ?" : " ORDER BY run.id"));
        if (id) rows.bind(1, *id);
        std::vector<RunSummary> runs;
        while (rows.executeStep()) tables::read_columns(rows, 0, runs.emplace_back());
        return runs;
    });
}

RunSummary RunRecords::summary(std::int64_t id) const {
    if (std::vector<RunSummary> found = summaries(id); !found.empty()) return std::move(found.front());
    const auto number = [&](const char* which) {
        return about(database_->file, [&] {
            return database_->sqlite.execAndGet(fmt::format("SELECT COALESCE({}(id), 0) FROM run", which)).getInt64();
        });
    };
    const std::int64_t first = number("MIN"), last = number("MAX");
    throw Error("there is no run {} in '{}'; {}", id, database_->file,
                last == 0 ? "it has no runs" : fmt::format("it has the runs {} to {}", first, last));
}

std::vector<RecordedFile> RunRecords::files() const {
    return about(database_->file, [&] {
        SQLite::Statement rows(database_->sqlite,
                               "SELECT cell.parent, CASE output.evidence WHEN '' THEN output.file ELSE output.evidence "
                               "END, output.sha256, "
                               "output.bytes FROM cell_outputs AS output JOIN cell ON cell.id = output.parent "
                               "WHERE output.outcome = 'ok' OR output.evidence <> '' ORDER BY cell.parent, output.id");
        std::vector<RecordedFile> files;
        while (rows.executeStep())
            files.push_back({rows.getColumn(0).getInt64(), rows.getColumn(1).getString(), rows.getColumn(2).getString(),
                             static_cast<std::uint64_t>(rows.getColumn(3).getInt64())});
        return files;
    });
}

std::vector<std::string> RunRecords::read_files(std::int64_t run) const {
    return about(database_->file, [&] {
        SQLite::Statement rows(database_->sqlite, "SELECT DISTINCT file FROM step WHERE parent = ? AND file <> ''");
        rows.bind(1, run);
        std::vector<std::string> files;
        while (rows.executeStep()) files.push_back(rows.getColumn(0).getString());
        return files;
    });
}

namespace {

/// Removes the rows of `table` that fulfil the condition, after the rows of other tables that belong to them.
void remove_rows(SQLite::Database& database, const std::string& table, const std::string& condition) {
    SQLite::Statement owned(database,
                            "SELECT name FROM sqlite_master JOIN pragma_foreign_key_list(sqlite_master.name) AS key "
                            "WHERE sqlite_master.type = 'table' AND key.\"table\" = ?");
    owned.bind(1, table);
    while (owned.executeStep())
        remove_rows(database, owned.getColumn(0).getString(),
                    "parent IN (SELECT id FROM " + table + " WHERE " + condition + ")");
    database.exec("DELETE FROM " + table + " WHERE " + condition);
}

}  // namespace

void RunRecords::remove(const std::vector<std::int64_t>& runs, const std::function<void(std::string)>& warn) {
    about(database_->file, [&] {
        SQLite::Transaction transaction(database_->sqlite, SQLite::TransactionBehavior::IMMEDIATE);
        for (const std::int64_t run : runs) remove_rows(database_->sqlite, "run", fmt::format("id = {}", run));
        transaction.commit();
    });
    try {
        database_->sqlite.exec("VACUUM");
    } catch (const SQLite::Exception& error) {
        warn(fmt::format("the records '{}' did not shrink: {}", database_->file, error.what()));
    }
}

std::vector<RunSummary> RunRecords::runs() const { return summaries(std::nullopt); }

RunDetails RunRecords::run(std::int64_t id) const {
    RunDetails details;
    details.summary = summary(id);
    return about(database_->file, [&] {
        SQLite::Database& sqlite = database_->sqlite;
        if (std::optional<RunRow> row = tables::read_row<RunRow>(sqlite, "run", id))
            details.start = std::move(row->start);
        details.steps = tables::read_rows<StepRecord>(sqlite, "step", {id}).objects;
        details.cells = tables::read_rows<CellRecord>(sqlite, "cell", {id}).objects;
        return details;
    });
}

// Acceptances and costs.

void RunRecords::accept(std::int64_t id, const std::string& who, const std::string& why) {
    const RunSummary run = summary(id);
    if (!run.outcome || *run.outcome == "interrupted")
        throw Error("run {} was interrupted; only a whole run can be accepted", id).hint("accept a run that has ended");
    about(database_->file, [&] { tables::insert(database_->statements, "acceptance", Decision{now(), who, why}, id); });
}

void RunRecords::revoke(const std::string& batch, const std::string& who, const std::string& why) {
    const std::optional<Acceptance> held = baseline(batch);
    if (!held) throw Error("no run of '{}' is accepted in '{}'", batch, database_->file);
    about(database_->file, [&] {
        tables::insert(database_->statements, "revocation", Decision{now(), who, why}, held->id);
    });
}

std::vector<Acceptance> RunRecords::acceptances() const {
    return about(database_->file, [&] {
        SQLite::Statement rows(
            database_->sqlite,
            "SELECT acceptance.id, acceptance.parent, run.workflow, acceptance.at, acceptance.who, "
            "acceptance.why, revocation.at, revocation.who, revocation.why FROM acceptance JOIN run "
            "ON run.id = acceptance.parent LEFT JOIN revocation ON revocation.parent = acceptance.id "
            "ORDER BY acceptance.id");
        std::vector<Acceptance> all;
        while (rows.executeStep()) {
            Acceptance& one = all.emplace_back();
            one.id = rows.getColumn(0).getInt64();
            one.run = rows.getColumn(1).getInt64();
            int column = 2;
            for (std::string* text : {&one.batch, &one.at, &one.who, &one.why})
                *text = rows.getColumn(column++).getString();
            if (!rows.getColumn(6).isNull()) one.revoked_at = rows.getColumn(6).getString();
            one.revoked_by = rows.getColumn(7).getString();
            one.revoked_why = rows.getColumn(8).getString();
        }
        return all;
    });
}

std::optional<Acceptance> RunRecords::baseline(const std::string& batch) const {
    std::optional<Acceptance> last;
    for (Acceptance& acceptance : acceptances())
        if (acceptance.batch == batch && !acceptance.revoked_at) last = std::move(acceptance);
    return last;
}

void RunRecords::acknowledge(Acknowledgement acknowledgement) {
    about(database_->file, [&] {
        acknowledgement.at = now();
        SQLite::Transaction transaction(database_->sqlite, SQLite::TransactionBehavior::IMMEDIATE);
        tables::insert(database_->statements, acknowledgement_table, acknowledgement);
        transaction.commit();
    });
}

std::vector<Acknowledgement> RunRecords::acknowledgements(const std::string& batch) const {
    return about(database_->file, [&] {
        std::vector<Acknowledgement> all;
        SQLite::Statement ids(database_->sqlite,
                              fmt::format("SELECT id FROM {} WHERE batch = ? ORDER BY id", acknowledgement_table));
        ids.bind(1, batch);
        while (ids.executeStep())
            if (auto row = tables::read_row<Acknowledgement>(database_->sqlite, acknowledgement_table,
                                                             ids.getColumn(0).getInt64()))
                all.push_back(std::move(*row));
        return all;
    });
}

std::vector<PastCosts> RunRecords::past_costs(const RunStart& like, std::int64_t first, std::int64_t end) const {
    return about(database_->file, [&] {
        SQLite::Statement rows(
            database_->sqlite,
            "SELECT cell.workflow, cell.scan, cell.variant, cost.seconds, cost.cpu_seconds, cost.peak_memory "
            "FROM cell JOIN cell_costs AS cost ON cost.parent = cell.id WHERE cell.parent IN (SELECT id FROM run WHERE "
            "workflow = ? AND machine = ? AND threads = ? AND jobs = ? AND id >= ? AND id < ? AND EXISTS "
            "(SELECT 1 FROM cell JOIN cell_costs AS cost ON cost.parent = cell.id WHERE cell.parent = run.id) "
            "ORDER BY id DESC LIMIT ?) ORDER BY cell.id, cost.id");
        SQLite::bind(rows, like.workflow, like.machine, like.threads, like.jobs, first, end, most_past_runs);
        std::vector<PastCosts> cells;
        std::map<std::tuple<std::string, std::string, std::string>, std::size_t> index_of;
        while (rows.executeStep()) {
            const std::tuple names(rows.getColumn(0).getString(), rows.getColumn(1).getString(),
                                   rows.getColumn(2).getString());
            const auto [found, is_new] = index_of.try_emplace(names, cells.size());
            if (is_new) cells.push_back({std::get<0>(names), std::get<1>(names), std::get<2>(names), {}});
            tables::read_columns(rows, 3, cells[found->second].costs.emplace_back());
        }
        return cells;
    });
}

std::vector<PastStep> RunRecords::last_steps(const std::string& workflow, const std::string& scan,
                                             const std::string& label) const {
    return about(database_->file, [&] {
        SQLite::Statement rows(
            database_->sqlite,
            "SELECT run.id, seed, outcome, filter, build, key, step.version, authored FROM step JOIN run ON "
            "run.id = step.parent WHERE step.parent = "
            "(SELECT MAX(parent) FROM step WHERE step.workflow = ?1 AND scan = ?2 AND step = ?3) "
            "AND step.workflow = ?1 AND scan = ?2 AND step = ?3 ORDER BY step.id");
        SQLite::bind(rows, workflow, scan, label);
        std::vector<PastStep> steps;
        while (rows.executeStep()) {
            PastStep& step = steps.emplace_back();
            step.run = rows.getColumn(0).getInt64();
            step.seed = static_cast<std::uint64_t>(rows.getColumn(1).getInt64());
            step.done = rows.getColumn(2).getString() == name_of(Outcome::ok);
            step.filter = rows.getColumn(3).getString();
            step.build = rows.getColumn(4).getString();
            step.plan_key = rows.getColumn(5).getString();
            step.filter_version = rows.getColumn(6).getInt();
            tables::Column<Texts>::read(rows.getColumn(7), step.authored);
        }
        return steps;
    });
}

}  // namespace scanmill
