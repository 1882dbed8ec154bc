// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/records/run_records.hpp"

#include <SQLiteCpp/Backup.h>
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

/// Runs `action`; errors of SQLite become Errors that name the file.
template <class Action>
auto about(const std::string& file, Action&& action) {
    try {
        return action();
    } catch (const SQLite::Exception& error) {
        throw Error("the records '{}': {}", file, error.what());
    }
}

/// One per version of the tables. A file of an older version runs those that follow it.
constexpr std::array<const char*, 4> migrations{R"(
CREATE TABLE run (id INTEGER PRIMARY KEY, started TEXT NOT NULL, workflow TEXT NOT NULL, file TEXT NOT NULL,
    arguments TEXT NOT NULL, seed TEXT NOT NULL, threads INTEGER NOT NULL, version TEXT NOT NULL, machine TEXT NOT NULL);
CREATE TABLE run_end (run INTEGER PRIMARY KEY REFERENCES run, ended TEXT NOT NULL, outcome TEXT NOT NULL,
    seconds REAL NOT NULL);
CREATE TABLE step (id INTEGER PRIMARY KEY, run INTEGER NOT NULL REFERENCES run, node INTEGER NOT NULL,
    label TEXT NOT NULL, filter TEXT NOT NULL, filter_version INTEGER NOT NULL, build TEXT NOT NULL, scan TEXT NOT NULL,
    plan_key TEXT NOT NULL, origin TEXT NOT NULL, why TEXT NOT NULL, outcome TEXT NOT NULL, error TEXT NOT NULL,
    seconds REAL NOT NULL, cpu_seconds REAL NOT NULL, peak_memory INTEGER, authored TEXT NOT NULL,
    resolved TEXT NOT NULL);
CREATE INDEX step_of_run ON step (run, node);
CREATE INDEX step_by_name ON step (label, scan, run);
CREATE TABLE metric (step INTEGER NOT NULL REFERENCES step, is_fact INTEGER NOT NULL, name TEXT NOT NULL, value REAL,
    unit TEXT NOT NULL);
CREATE INDEX metric_of_step ON metric (step);
CREATE TABLE warning (step INTEGER NOT NULL REFERENCES step, text TEXT NOT NULL);
CREATE INDEX warning_of_step ON warning (step);
CREATE TABLE cell (id INTEGER PRIMARY KEY, run INTEGER NOT NULL REFERENCES run, scan TEXT NOT NULL,
    variant TEXT NOT NULL, outcome TEXT NOT NULL, error TEXT NOT NULL, seconds REAL NOT NULL);
CREATE INDEX cell_of_run ON cell (run);
CREATE TABLE cell_step (cell INTEGER NOT NULL REFERENCES cell, step INTEGER NOT NULL REFERENCES step);
CREATE INDEX step_of_cell ON cell_step (cell);
CREATE TABLE output (id INTEGER PRIMARY KEY, cell INTEGER NOT NULL REFERENCES cell, file TEXT NOT NULL,
    kind TEXT NOT NULL, outcome TEXT NOT NULL);
CREATE INDEX output_of_cell ON output (cell);
CREATE TABLE output_fact (output INTEGER NOT NULL REFERENCES output, name TEXT NOT NULL, value REAL, unit TEXT NOT NULL);
CREATE INDEX fact_of_output ON output_fact (output);
)",
                                                R"(
ALTER TABLE run ADD COLUMN jobs INTEGER NOT NULL DEFAULT 0;
ALTER TABLE run ADD COLUMN libraries TEXT NOT NULL DEFAULT '';
ALTER TABLE step ADD COLUMN workflow TEXT NOT NULL DEFAULT '';
ALTER TABLE step ADD COLUMN cause TEXT NOT NULL DEFAULT '';
ALTER TABLE step ADD COLUMN cause_number INTEGER NOT NULL DEFAULT 0;
ALTER TABLE step ADD COLUMN threads INTEGER NOT NULL DEFAULT 0;
ALTER TABLE step ADD COLUMN attempts INTEGER NOT NULL DEFAULT 0;
ALTER TABLE cell ADD COLUMN workflow TEXT NOT NULL DEFAULT '';
ALTER TABLE cell ADD COLUMN cause TEXT NOT NULL DEFAULT '';
ALTER TABLE cell ADD COLUMN cause_number INTEGER NOT NULL DEFAULT 0;
UPDATE step SET workflow = (SELECT workflow FROM run WHERE run.id = step.run);
UPDATE cell SET workflow = (SELECT workflow FROM run WHERE run.id = cell.run);
CREATE TABLE log (step INTEGER NOT NULL REFERENCES step, line TEXT NOT NULL);
CREATE INDEX log_of_step ON log (step);
)",
                                                R"(
CREATE TABLE doubt (cell INTEGER NOT NULL REFERENCES cell, text TEXT NOT NULL);
CREATE INDEX doubt_of_cell ON doubt (cell);
UPDATE run_end SET outcome = 'ok' WHERE outcome = 'done';
UPDATE step SET outcome = 'ok' WHERE outcome = 'done';
UPDATE cell SET outcome = 'ok' WHERE outcome = 'done';
UPDATE output SET outcome = 'ok' WHERE outcome = 'done';
)",
                                                R"(
ALTER TABLE run ADD COLUMN gate TEXT NOT NULL DEFAULT '';
ALTER TABLE step ADD COLUMN measures TEXT NOT NULL DEFAULT '';
ALTER TABLE step ADD COLUMN metrics_unit TEXT NOT NULL DEFAULT 'u';
ALTER TABLE step ADD COLUMN properties_unit TEXT NOT NULL DEFAULT 'u';
ALTER TABLE output ADD COLUMN unit TEXT NOT NULL DEFAULT 'u';
ALTER TABLE cell ADD COLUMN truth TEXT NOT NULL DEFAULT '';
ALTER TABLE output ADD COLUMN sha256 TEXT NOT NULL DEFAULT '';
ALTER TABLE output ADD COLUMN bytes INTEGER NOT NULL DEFAULT 0;
ALTER TABLE output ADD COLUMN moved_to TEXT NOT NULL DEFAULT '';
CREATE TABLE cost (cell INTEGER NOT NULL REFERENCES cell, seconds REAL NOT NULL, cpu_seconds REAL NOT NULL,
    peak_memory INTEGER NOT NULL);
CREATE INDEX cost_of_cell ON cost (cell);
CREATE TABLE acceptance (id INTEGER PRIMARY KEY, run INTEGER NOT NULL REFERENCES run, at TEXT NOT NULL,
    who TEXT NOT NULL, why TEXT NOT NULL);
CREATE TABLE revocation (acceptance INTEGER PRIMARY KEY REFERENCES acceptance, at TEXT NOT NULL, who TEXT NOT NULL,
    why TEXT NOT NULL);
DROP INDEX step_of_run;
CREATE INDEX step_of_run ON step (run, node, origin);
ALTER TABLE run_end ADD COLUMN cells INTEGER;
ALTER TABLE run_end ADD COLUMN doubtful INTEGER;
ALTER TABLE run_end ADD COLUMN failed INTEGER;
ALTER TABLE run_end ADD COLUMN ran INTEGER;
ALTER TABLE run_end ADD COLUMN cached INTEGER;
-- Counted once, when a run ends. A node whose cached value was lost has two steps, and counts as run.
CREATE VIEW run_counts AS SELECT run.id AS run,
    COALESCE(run_end.cells, (SELECT COUNT(*) FROM cell WHERE cell.run = run.id)) AS cells,
    COALESCE(run_end.doubtful, (SELECT COUNT(*) FROM cell WHERE cell.run = run.id AND cell.outcome = 'doubtful'))
        AS doubtful,
    COALESCE(run_end.failed, (SELECT COUNT(*) FROM cell WHERE cell.run = run.id AND cell.outcome = 'failed')) AS failed,
    COALESCE(run_end.ran, (SELECT COUNT(DISTINCT node) FROM step WHERE step.run = run.id AND origin = 'ran')) AS ran,
    COALESCE(run_end.cached, (SELECT COUNT(DISTINCT node) - COUNT(DISTINCT CASE origin WHEN 'ran' THEN node END)
        FROM step WHERE step.run = run.id)) AS cached
    FROM run LEFT JOIN run_end ON run_end.run = run.id;
UPDATE run_end SET (cells, doubtful, failed, ran, cached) =
    (SELECT cells, doubtful, failed, ran, cached FROM run_counts WHERE run_counts.run = run_end.run);
)"};

}  // namespace

struct RunRecords::Database {
    Database(const std::filesystem::path& path, int flags) : file(path.string()), sqlite(file, flags, patience) {}

    /// Brings the tables to the last version; creates them in an empty file.
    void migrate();
    int version() { return sqlite.execAndGet("PRAGMA user_version").getInt(); }
    /// Throws Error for tables of a newer Scanmill.
    void require_known(int version) const;

    static constexpr int patience = 1000;  // milliseconds, while another run writes
    std::string file;
    SQLite::Database sqlite;
    std::map<std::pair<std::int64_t, std::size_t>, std::int64_t> step_ids;  // by run and node
    std::map<std::tuple<std::int64_t, std::string, std::string, std::string>, std::int64_t>
        cell_ids;  // by run, workflow, scan and variant
};

void RunRecords::Database::migrate() {
    if (version() == static_cast<int>(migrations.size())) return;  // writing that again would cost four syncs
    SQLite::Transaction transaction(sqlite, SQLite::TransactionBehavior::IMMEDIATE);
    const int found = version();
    require_known(found);
    for (std::size_t next = static_cast<std::size_t>(found); next < migrations.size(); ++next)
        sqlite.exec(migrations[next]);
    sqlite.exec(fmt::format("PRAGMA user_version = {}", migrations.size()));
    transaction.commit();
}

void RunRecords::Database::require_known(int found) const {
    if (found >= 0 && static_cast<std::size_t>(found) <= migrations.size()) return;
    throw Error(
        "the records '{}' were written by a newer Scanmill: their tables are of version {}, this one reads up to {}",
        file, found, migrations.size())
        .hint("use that Scanmill, or another output folder");
}

RunRecords::RunRecords(std::unique_ptr<Database> database) : database_(std::move(database)) {}
RunRecords::RunRecords(RunRecords&&) noexcept = default;
RunRecords::~RunRecords() = default;

/// A symbolic link may lead anywhere; runs write only into their output folder.
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

static std::filesystem::path folder_of(const std::filesystem::path& file) {
    return file.has_parent_path() ? file.parent_path() : ".";
}

RunRecords RunRecords::append_to(const std::filesystem::path& file) {
    require_in_its_folder(file);
    return about(file.string(), [&] {
        auto database = std::make_unique<Database>(file, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
        database->migrate();
        return RunRecords(std::move(database));
    });
}

std::unique_ptr<RunRecords::Database> RunRecords::open_to_read(const std::filesystem::path& file) {
    try {
        auto database = std::make_unique<Database>(file, SQLite::OPEN_READONLY);
        database->version();
        return database;
    } catch (const SQLite::Exception& error) {
        if (error.getErrorCode() != SQLITE_READONLY) throw;
    }
    // A killed run left the journal of an unfinished transaction, which only a writer can roll back.
    return std::make_unique<Database>(file, SQLite::OPEN_READWRITE);
}

RunRecords RunRecords::read(const std::filesystem::path& file) {
    return about(file.string(), [&] {
        if (!std::filesystem::exists(file))
            throw Error("the file '{}' does not exist", file.string()).hint("name the output folder of a run");
        std::unique_ptr<Database> database = open_to_read(file);
        const int version = database->version();
        if (version == 0) throw Error("'{}' contains no run records", file.string());
        database->require_known(version);
        if (static_cast<std::size_t>(version) == migrations.size()) return RunRecords(std::move(database));
        if (::access(file.c_str(), W_OK) == 0 && ::access(folder_of(file).c_str(), W_OK) == 0) return append_to(file);
        auto copy = std::make_unique<Database>(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
        SQLite::Backup(copy->sqlite, database->sqlite).executeStep();
        copy->file = file.string();
        copy->migrate();
        return RunRecords(std::move(copy));
    });
}

namespace {

using Json = nlohmann::ordered_json;
using Texts = std::vector<std::pair<std::string, std::string>>;
using Words = std::vector<std::string>;

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

void bind_value(SQLite::Statement& statement, int index, std::integral auto number) {
    statement.bind(index, static_cast<std::int64_t>(number));
}
void bind_value(SQLite::Statement& statement, int index, double number) {
    if (std::isnan(number))
        statement.bind(index);
    else
        statement.bind(index, number);
}
void bind_value(SQLite::Statement& statement, int index, const std::string& text) { statement.bind(index, text); }
/// The unit of a list of metrics: of their lengths, as "mm"; "u" if it is unknown.
void bind_value(SQLite::Statement& statement, int index, LengthUnit unit) {
    statement.bind(index, std::string(symbol(unit)));
}
void bind_value(SQLite::Statement& statement, int index, const Words& words) { statement.bind(index, dumped(words)); }
void bind_value(SQLite::Statement& statement, int index, const Texts& texts) {
    Json json = Json::object();
    for (const auto& [name, value] : texts) json[name] = value;
    statement.bind(index, dumped(json));
}

template <class... Values>
void bind_all(SQLite::Statement& statement, const Values&... values) {
    int index = 0;
    (bind_value(statement, ++index, values), ...);
}

void read_value(const SQLite::Column& column, std::integral auto& number) {
    number = static_cast<std::remove_reference_t<decltype(number)>>(column.getInt64());
}
void read_value(const SQLite::Column& column, double& number) {
    number = column.isNull() ? std::nan("") : column.getDouble();
}
void read_value(const SQLite::Column& column, std::string& text) { text = column.getString(); }
void read_value(const SQLite::Column& column, std::optional<std::string>& text) {
    if (!column.isNull()) text = column.getString();
}
void read_value(const SQLite::Column& column, LengthUnit& unit) {
    unit = length_unit(column.getString()).value_or(LengthUnit::unknown);
}
void read_value(const SQLite::Column& column, Words& words) {
    for (const Json& word : Json::parse(column.getString(), nullptr, false))
        if (word.is_string()) words.push_back(word.get<std::string>());
}
void read_value(const SQLite::Column& column, Texts& texts) {
    const Json json = Json::parse(column.getString(), nullptr, false);
    for (const auto& [name, value] : json.items())
        if (value.is_string()) texts.emplace_back(name, value.get<std::string>());
}

/// Reads columns from `first` on.
template <class... Fields>
void read_row(SQLite::Statement& row, int first, Fields&... fields) {
    (read_value(row.getColumn(first++), fields), ...);
}

Metric read_metric(SQLite::Statement& row, int first) {
    Metric metric{};
    std::string unit;
    read_row(row, first, metric.name, metric.value, unit);
    metric.unit = value_named<Unit>(unit).value_or(Unit::number);
    return metric;
}

/// Inserts rows into a table, given as "name" or "name (column, …)".
class Insertion {
public:
    Insertion(SQLite::Database& database, std::string table) : database_(database), table_(std::move(table)) {}

    /// Returns the ID of the new row.
    template <class... Values>
    std::int64_t add(const Values&... values) {
        if (!statement_) {
            std::string marks = "?";
            for (std::size_t i = 1; i < sizeof...(values); ++i) marks += ", ?";
            statement_.emplace(database_, "INSERT INTO " + table_ + " VALUES (" + marks + ")");
        }
        bind_all(*statement_, values...);
        statement_->exec();
        statement_->reset();
        return database_.getLastInsertRowid();
    }

private:
    SQLite::Database& database_;
    std::string table_;
    std::optional<SQLite::Statement> statement_;
};

/// A prepared SELECT.
class Selection {
public:
    Selection(SQLite::Database& database, const std::string& sql) : statement_(database, sql) {}

    /// Binds the keys and calls action(row) for every row.
    template <class Action, class... Keys>
    void each(Action&& action, const Keys&... keys) {
        bind_all(statement_, keys...);
        while (statement_.executeStep()) action(statement_);
        statement_.reset();
    }

private:
    SQLite::Statement statement_;
};

/// Reads the rows of a table that belong to rows of another one, given by their ascending IDs. `sql` selects the
/// other's ID first, between two parameters, and sorts by it. Calls action(index into `ids`, row).
template <class Action>
void each_of(SQLite::Database& database, const std::string& sql, const std::vector<std::int64_t>& ids,
             Action&& action) {
    if (ids.empty()) return;
    std::size_t index = 0;
    Selection(database, sql)
        .each(
            [&](SQLite::Statement& row) {
                const std::int64_t id = row.getColumn(0).getInt64();
                while (ids[index] < id) ++index;
                if (ids[index] == id) action(index, row);
            },
            ids.front(), ids.back());
}

// The columns of each table and, in the same order, the fields of its record.

const std::string run_columns = "workflow, file, arguments, threads, jobs, version, machine, libraries, gate";
template <class Start>
auto fields_of_run(Start& start) {
    return std::tie(start.workflow, start.file, start.arguments, start.threads, start.jobs, start.version,
                    start.machine, start.libraries, start.gate);
}

const std::string step_columns =
    "node, label, filter, filter_version, build, scan, plan_key, origin, why, outcome, error, seconds, cpu_seconds, "
    "authored, resolved, workflow, cause, cause_number, peak_memory, threads, attempts, measures, metrics_unit, "
    "properties_unit";
template <class Step>
auto fields_of_step(Step& step) {
    return std::tie(step.node, step.label, step.filter, step.filter_version, step.build, step.scan, step.plan_key,
                    step.origin, step.why, step.outcome, step.failure.error, step.seconds, step.cpu_seconds,
                    step.authored, step.resolved, step.workflow, step.failure.cause, step.failure.number,
                    step.peak_memory, step.threads, step.attempts, step.measures, step.metrics.unit,
                    step.properties.unit);
}

const std::string cell_columns = "scan, variant, outcome, error, seconds, workflow, cause, cause_number, truth";
template <class Cell>
auto fields_of_cell(Cell& cell) {
    return std::tie(cell.scan, cell.variant, cell.outcome, cell.failure.error, cell.seconds, cell.workflow,
                    cell.failure.cause, cell.failure.number, cell.truth);
}

const std::string output_columns = "file, kind, outcome, sha256, bytes, moved_to, unit";
template <class Output>
auto fields_of_output(Output& output) {
    return std::tie(output.file, output.kind, output.outcome, output.sha256, output.bytes, output.moved_to,
                    output.properties.unit);
}

const std::string cost_columns = "seconds, cpu_seconds, peak_memory";
template <class Cost>
auto fields_of_cost(Cost& cost) {
    return std::tie(cost.seconds, cost.cpu_seconds, cost.peak_memory);
}

template <class Record>
void read_fields(SQLite::Statement& row, int first, const Record& fields) {
    std::apply([&](auto&... each) { read_row(row, first, each...); }, fields);
}

}  // namespace

std::string RunRecords::now() const {
    return database_->sqlite.execAndGet("SELECT strftime('%Y-%m-%dT%H:%M:%SZ', 'now')").getString();
}

std::int64_t RunRecords::begin(const RunStart& start) {
    return about(database_->file, [&] {
        const std::string started = now();
        Insertion runs(database_->sqlite, "run (started, seed, " + run_columns + ")");
        return std::apply(
            [&](const auto&... fields) { return runs.add(started, std::to_string(start.seed), fields...); },
            fields_of_run(start));
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
    SQLite::Database& sqlite = database_->sqlite;
    Insertion step_rows(sqlite, "step (run, " + step_columns + ")"), metrics(sqlite, "metric"),
        warnings(sqlite, "warning"), log(sqlite, "log");
    for (const StepRecord& step : steps) {
        const std::int64_t id =
            std::apply([&](const auto&... fields) { return step_rows.add(run, fields...); }, fields_of_step(step));
        database_->step_ids[{run, step.node}] = id;
        for (const Metrics* list : {&step.metrics, &step.properties})
            for (const Metric& metric : list->values)
                metrics.add(id, list == &step.properties, metric.name, metric.value, std::string(name_of(metric.unit)));
        for (const std::string& text : step.warnings) warnings.add(id, text);
        for (const std::string& line : step.log) log.add(id, line);
    }
    Insertion cell_rows(sqlite, "cell (run, " + cell_columns + ")"), links(sqlite, "cell_step"),
        doubts(sqlite, "doubt"), outputs(sqlite, "output (cell, " + output_columns + ")"),
        properties(sqlite, "output_fact"), costs(sqlite, "cost (cell, " + cost_columns + ")");
    for (const CellRecord& cell : cells) {
        const std::int64_t id =
            std::apply([&](const auto&... fields) { return cell_rows.add(run, fields...); }, fields_of_cell(cell));
        database_->cell_ids[{run, cell.workflow, cell.scan, cell.variant}] = id;
        for (const std::size_t node : cell.nodes)
            if (const auto step = database_->step_ids.find({run, node}); step != database_->step_ids.end())
                links.add(id, step->second);
        for (const std::string& text : cell.doubts) doubts.add(id, text);
        for (const OutputRecord& output : cell.outputs) {
            const std::int64_t output_id =
                std::apply([&](const auto&... fields) { return outputs.add(id, fields...); }, fields_of_output(output));
            for (const Metric& property : output.properties.values)
                properties.add(output_id, property.name, property.value, std::string(name_of(property.unit)));
        }
        for (const CostRecord& cost : cell.costs)
            std::apply([&](const auto&... fields) { costs.add(id, fields...); }, fields_of_cost(cost));
    }
}

void RunRecords::end(std::int64_t run, const std::vector<StepRecord>& steps, const std::vector<CellRecord>& cells,
                     const std::string& outcome, double seconds) {
    about(database_->file, [&] {
        SQLite::Transaction transaction(database_->sqlite);
        insert(run, steps, cells);
        SQLite::Statement ending(database_->sqlite,
                                 "INSERT INTO run_end SELECT run, strftime('%Y-%m-%dT%H:%M:%SZ', 'now'), ?, ?, cells, "
                                 "doubtful, failed, ran, cached FROM run_counts WHERE run = ?");
        bind_all(ending, outcome, seconds, run);
        ending.exec();
        transaction.commit();
    });
}

void RunRecords::add_costs(std::int64_t run, const std::vector<PastCosts>& cells) {
    about(database_->file, [&] {
        SQLite::Transaction transaction(database_->sqlite);
        Insertion rows(database_->sqlite, "cost (cell, " + cost_columns + ")");
        for (const PastCosts& cell : cells)
            for (const CostRecord& cost : cell.costs)
                std::apply(
                    [&](const auto&... fields) {
                        rows.add(database_->cell_ids.at({run, cell.workflow, cell.scan, cell.variant}), fields...);
                    },
                    fields_of_cost(cost));
        transaction.commit();
    });
}

std::vector<RunSummary> RunRecords::summaries(std::optional<std::int64_t> id) const {
    return about(database_->file, [&] {
        const std::string sql =
            "SELECT run.id, started, workflow, run_end.outcome, COALESCE(run_end.seconds, 0), counts.cells, "
            "counts.doubtful, counts.failed, counts.ran, counts.cached FROM run LEFT JOIN run_end ON run_end.run = "
            "run.id JOIN run_counts AS counts ON counts.run = run.id";
        std::vector<RunSummary> runs;
        const auto add = [&](SQLite::Statement& row) {
            RunSummary& run = runs.emplace_back();
            read_row(row, 0, run.id, run.started, run.workflow, run.outcome, run.seconds, run.cells, run.doubtful,
                     run.failed, run.ran, run.cached);
        };
        if (id)
            Selection(database_->sqlite, sql + " WHERE run.id = ?").each(add, *id);
        else
            Selection(database_->sqlite, sql + " ORDER BY run.id").each(add);
        return runs;
    });
}

RunSummary RunRecords::summary(std::int64_t id) const {
    if (std::vector<RunSummary> found = summaries(id); !found.empty()) return std::move(found.front());
    const std::int64_t last = about(database_->file, [&] {
        return database_->sqlite.execAndGet("SELECT COALESCE(MAX(id), 0) FROM run").getInt64();
    });
    throw Error("there is no run {} in '{}'; {}", id, database_->file,
                last == 0 ? "there are none" : fmt::format("there are 1 to {}", last));
}

std::vector<RunSummary> RunRecords::runs() const { return summaries(std::nullopt); }

RunDetails RunRecords::run(std::int64_t id) const {
    RunDetails details;
    details.summary = summary(id);
    return about(database_->file, [&] {
        SQLite::Database& sqlite = database_->sqlite;
        Selection(sqlite, "SELECT seed, " + run_columns + " FROM run WHERE id = ?")
            .each(
                [&](SQLite::Statement& row) {
                    details.start.seed = std::stoull(row.getColumn(0).getString());
                    read_fields(row, 1, fields_of_run(details.start));
                },
                id);

        // The rows of a run lie together: each table is read once, in its order, and not row by row of its parents.
        std::vector<std::int64_t> ids;
        const auto rows_of_run = [&](const std::string& table, const std::string& columns) {
            ids.clear();
            return fmt::format(
                "SELECT id, {1} FROM {0} WHERE +run = ?1 AND id BETWEEN (SELECT MIN(id) FROM {0} WHERE run = ?1) AND "
                "(SELECT MAX(id) FROM {0} WHERE run = ?1) ORDER BY id",
                table, columns);
        };
        Selection(sqlite, rows_of_run("step", step_columns))
            .each(
                [&](SQLite::Statement& row) {
                    ids.push_back(row.getColumn(0).getInt64());
                    read_fields(row, 1, fields_of_step(details.steps.emplace_back()));
                },
                id);
        each_of(sqlite,
                "SELECT step, is_fact, name, value, unit FROM metric WHERE step BETWEEN ? AND ? ORDER BY step, "
                "rowid",
                ids, [&](std::size_t index, SQLite::Statement& row) {
                    StepRecord& step = details.steps[index];
                    (row.getColumn(1).getInt() ? step.properties : step.metrics).values.push_back(read_metric(row, 2));
                });
        each_of(sqlite, "SELECT step, text FROM warning WHERE step BETWEEN ? AND ? ORDER BY step, rowid", ids,
                [&](std::size_t index, SQLite::Statement& row) {
                    details.steps[index].warnings.push_back(row.getColumn(1).getString());
                });
        each_of(sqlite, "SELECT step, line FROM log WHERE step BETWEEN ? AND ? ORDER BY step, rowid", ids,
                [&](std::size_t index, SQLite::Statement& row) {
                    details.steps[index].log.push_back(row.getColumn(1).getString());
                });

        Selection(sqlite, rows_of_run("cell", cell_columns))
            .each(
                [&](SQLite::Statement& row) {
                    ids.push_back(row.getColumn(0).getInt64());
                    read_fields(row, 1, fields_of_cell(details.cells.emplace_back()));
                },
                id);
        each_of(sqlite,
                "SELECT cell_step.cell, node FROM cell_step JOIN step ON step.id = cell_step.step WHERE "
                "cell_step.cell BETWEEN ? AND ? ORDER BY cell_step.cell, cell_step.rowid",
                ids, [&](std::size_t index, SQLite::Statement& row) {
                    read_row(row, 1, details.cells[index].nodes.emplace_back());
                });
        each_of(sqlite, "SELECT cell, text FROM doubt WHERE cell BETWEEN ? AND ? ORDER BY cell, rowid", ids,
                [&](std::size_t index, SQLite::Statement& row) {
                    details.cells[index].doubts.push_back(row.getColumn(1).getString());
                });
        each_of(sqlite, "SELECT cell, " + cost_columns + " FROM cost WHERE cell BETWEEN ? AND ? ORDER BY cell, rowid",
                ids, [&](std::size_t index, SQLite::Statement& row) {
                    read_fields(row, 1, fields_of_cost(details.cells[index].costs.emplace_back()));
                });
        std::vector<std::int64_t> output_ids;
        std::vector<std::pair<std::size_t, std::size_t>> places;  // of outputs: cell, and index in it
        each_of(sqlite,
                "SELECT cell, id, " + output_columns + " FROM output WHERE cell BETWEEN ? AND ? ORDER BY cell, id", ids,
                [&](std::size_t index, SQLite::Statement& row) {
                    std::vector<OutputRecord>& outputs = details.cells[index].outputs;
                    output_ids.push_back(row.getColumn(1).getInt64());
                    places.emplace_back(index, outputs.size());
                    read_fields(row, 2, fields_of_output(outputs.emplace_back()));
                });
        each_of(sqlite,
                "SELECT output, name, value, unit FROM output_fact WHERE output BETWEEN ? AND ? ORDER BY "
                "output, rowid",
                output_ids, [&](std::size_t index, SQLite::Statement& row) {
                    const auto& [cell, output] = places[index];
                    details.cells[cell].outputs[output].properties.values.push_back(read_metric(row, 1));
                });
        return details;
    });
}

// Acceptances and costs.

void RunRecords::accept(std::int64_t id, const std::string& who, const std::string& why) {
    const RunSummary run = summary(id);
    if (!run.outcome || *run.outcome == "interrupted")
        throw Error("run {} was interrupted; only a whole run can be accepted", id).hint("accept a run that has ended");
    about(database_->file,
          [&] { Insertion(database_->sqlite, "acceptance (run, at, who, why)").add(id, now(), who, why); });
}

void RunRecords::revoke(const std::string& batch, const std::string& who, const std::string& why) {
    const std::optional<Acceptance> held = baseline(batch);
    if (!held) throw Error("no run of '{}' is accepted in '{}'", batch, database_->file);
    about(database_->file, [&] {
        Insertion(database_->sqlite, "revocation (acceptance, at, who, why)").add(held->id, now(), who, why);
    });
}

std::vector<Acceptance> RunRecords::acceptances(const std::string& condition, const std::string& key) const {
    return about(database_->file, [&] {
        std::vector<Acceptance> all;
        const auto add = [&](SQLite::Statement& row) {
            Acceptance& one = all.emplace_back();
            read_row(row, 0, one.id, one.run, one.at, one.who, one.why, one.revoked_at, one.revoked_by,
                     one.revoked_why);
        };
        Selection rows(database_->sqlite,
                       "SELECT acceptance.id, acceptance.run, acceptance.at, acceptance.who, acceptance.why, "
                       "revocation.at, COALESCE(revocation.who, ''), COALESCE(revocation.why, '') FROM acceptance LEFT "
                       "JOIN revocation ON revocation.acceptance = acceptance.id " +
                           condition);
        if (key.empty())
            rows.each(add);
        else
            rows.each(add, key);
        return all;
    });
}

std::vector<Acceptance> RunRecords::acceptances() const { return acceptances("ORDER BY acceptance.id", ""); }

std::optional<Acceptance> RunRecords::baseline(const std::string& batch) const {
    std::vector<Acceptance> found = acceptances(
        "JOIN run ON run.id = acceptance.run WHERE run.workflow = ? AND revocation.at IS NULL ORDER BY acceptance.id "
        "DESC LIMIT 1",
        batch);
    if (found.empty()) return std::nullopt;
    return std::move(found.front());
}

std::vector<PastCosts> RunRecords::past_costs(const RunStart& like, std::int64_t first, std::int64_t end) const {
    return about(database_->file, [&] {
        std::vector<PastCosts> cells;
        std::map<std::tuple<std::string, std::string, std::string>, std::size_t> index_of;
        Selection rows(
            database_->sqlite,
            "SELECT cell.workflow, cell.scan, cell.variant, cost.seconds, cost.cpu_seconds, cost.peak_memory "
            "FROM cell JOIN cost ON cost.cell = cell.id WHERE cell.run IN (SELECT id FROM run WHERE "
            "workflow = ? AND machine = ? AND threads = ? AND jobs = ? AND id >= ? AND id < ? AND EXISTS "
            "(SELECT 1 FROM cell JOIN cost ON cost.cell = cell.id WHERE cell.run = run.id) "
            "ORDER BY id DESC LIMIT ?) ORDER BY cell.id, cost.rowid");
        const auto add = [&](SQLite::Statement& row) {
            std::tuple<std::string, std::string, std::string> names;
            std::apply([&](auto&... each) { read_row(row, 0, each...); }, names);
            const auto [found, is_new] = index_of.try_emplace(names, cells.size());
            if (is_new) {
                PastCosts& cell = cells.emplace_back();
                std::tie(cell.workflow, cell.scan, cell.variant) = names;
            }
            read_fields(row, 3, fields_of_cost(cells[found->second].costs.emplace_back()));
        };
        rows.each(add, like.workflow, like.machine, like.threads, like.jobs, first, end, most_past_runs);
        return cells;
    });
}

std::vector<PastStep> RunRecords::last_steps(const std::string& workflow, const std::string& scan,
                                             const std::string& label) const {
    return about(database_->file, [&] {
        Selection rows(
            database_->sqlite,
            "SELECT run.id, seed, outcome, filter, build, plan_key, filter_version, authored FROM step JOIN run ON "
            "run.id = step.run WHERE step.run = "
            "(SELECT MAX(run) FROM step WHERE step.workflow = ?1 AND scan = ?2 AND label = ?3) "
            "AND step.workflow = ?1 AND scan = ?2 AND label = ?3 ORDER BY step.id");
        std::vector<PastStep> steps;
        rows.each(
            [&](SQLite::Statement& row) {
                PastStep& step = steps.emplace_back();
                step.run = row.getColumn(0).getInt64();
                step.seed = std::stoull(row.getColumn(1).getString());
                step.done = row.getColumn(2).getString() == "ok";
                read_row(row, 3, step.filter, step.build, step.plan_key, step.filter_version, step.authored);
            },
            workflow, scan, label);
        return steps;
    });
}

}  // namespace scanmill
