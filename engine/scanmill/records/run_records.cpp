// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/records/run_records.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

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
constexpr std::array<const char*, 3> migrations{R"(
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

RunRecords RunRecords::append_to(const std::filesystem::path& file) {
    require_in_its_folder(file);
    return about(file.string(), [&] {
        auto database = std::make_unique<Database>(file, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
        database->migrate();
        return RunRecords(std::move(database));
    });
}

RunRecords RunRecords::read(const std::filesystem::path& file) {
    return about(file.string(), [&] {
        if (!std::filesystem::exists(file))
            throw Error("the file '{}' does not exist", file.string()).hint("name the output folder of a run");
        auto database = std::make_unique<Database>(file, SQLite::OPEN_READONLY);
        const int version = database->version();
        if (version == 0) throw Error("'{}' contains no run records", file.string());
        database->require_known(version);
        if (static_cast<std::size_t>(version) < migrations.size()) return append_to(file);  // brings them up to date
        return RunRecords(std::move(database));
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
    metric.unit = unit_named(unit).value_or(Unit::number);
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

// The columns of each table and, in the same order, the fields of its record.

const std::string run_columns = "workflow, file, arguments, threads, jobs, version, machine, libraries";
template <class Start>
auto fields_of_run(Start& start) {
    return std::tie(start.workflow, start.file, start.arguments, start.threads, start.jobs, start.version,
                    start.machine, start.libraries);
}

const std::string step_columns =
    "node, label, filter, filter_version, build, scan, plan_key, origin, why, outcome, error, seconds, cpu_seconds, "
    "authored, resolved, workflow, cause, cause_number, peak_memory, threads, attempts";
template <class Step>
auto fields_of_step(Step& step) {
    return std::tie(step.node, step.label, step.filter, step.filter_version, step.build, step.scan, step.plan_key,
                    step.origin, step.why, step.outcome, step.failure.error, step.seconds, step.cpu_seconds,
                    step.authored, step.resolved, step.workflow, step.failure.cause, step.failure.number,
                    step.peak_memory, step.threads, step.attempts);
}

const std::string cell_columns = "scan, variant, outcome, error, seconds, workflow, cause, cause_number";
template <class Cell>
auto fields_of_cell(Cell& cell) {
    return std::tie(cell.scan, cell.variant, cell.outcome, cell.failure.error, cell.seconds, cell.workflow,
                    cell.failure.cause, cell.failure.number);
}

}  // namespace

std::int64_t RunRecords::begin(const RunStart& start) {
    return about(database_->file, [&] {
        const auto started = database_->sqlite.execAndGet("SELECT strftime('%Y-%m-%dT%H:%M:%SZ', 'now')").getString();
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
        doubts(sqlite, "doubt"), outputs(sqlite, "output (cell, file, kind, outcome)"),
        properties(sqlite, "output_fact");
    for (const CellRecord& cell : cells) {
        const std::int64_t id =
            std::apply([&](const auto&... fields) { return cell_rows.add(run, fields...); }, fields_of_cell(cell));
        for (const std::size_t node : cell.nodes)
            if (const auto step = database_->step_ids.find({run, node}); step != database_->step_ids.end())
                links.add(id, step->second);
        for (const std::string& text : cell.doubts) doubts.add(id, text);
        for (const OutputRecord& output : cell.outputs) {
            const std::int64_t output_id = outputs.add(id, output.file, output.kind, output.outcome);
            for (const Metric& property : output.properties.values)
                properties.add(output_id, property.name, property.value, std::string(name_of(property.unit)));
        }
    }
}

void RunRecords::end(std::int64_t run, const std::vector<StepRecord>& steps, const std::vector<CellRecord>& cells,
                     const std::string& outcome, double seconds) {
    about(database_->file, [&] {
        SQLite::Transaction transaction(database_->sqlite);
        insert(run, steps, cells);
        SQLite::Statement ending(database_->sqlite,
                                 "INSERT INTO run_end VALUES (?, strftime('%Y-%m-%dT%H:%M:%SZ', 'now'), ?, ?)");
        bind_all(ending, run, outcome, seconds);
        ending.exec();
        transaction.commit();
    });
}

std::vector<RunSummary> RunRecords::runs() const {
    return about(database_->file, [&] {
        Selection rows(
            database_->sqlite,
            "SELECT run.id, started, workflow, run_end.outcome, COALESCE(run_end.seconds, 0), "
            "(SELECT COUNT(*) FROM cell WHERE cell.run = run.id), "
            "(SELECT COUNT(*) FROM cell WHERE cell.run = run.id AND outcome = 'doubtful'), "
            "(SELECT COUNT(*) FROM cell WHERE cell.run = run.id AND outcome = 'failed'), "
            "(SELECT COUNT(DISTINCT node) FROM step WHERE step.run = run.id AND origin = 'ran'), "
            // A node whose cached value was lost has two rows, and counts as run.
            "(SELECT COUNT(DISTINCT node) FROM step WHERE step.run = run.id AND origin != 'ran' AND node NOT IN "
            "(SELECT node FROM step WHERE step.run = run.id AND origin = 'ran')) "
            "FROM run LEFT JOIN run_end ON run_end.run = run.id ORDER BY run.id");
        std::vector<RunSummary> runs;
        rows.each([&](SQLite::Statement& row) {
            RunSummary& run = runs.emplace_back();
            read_row(row, 0, run.id, run.started, run.workflow, run.outcome, run.seconds, run.cells, run.doubtful,
                     run.failed, run.ran, run.cached);
        });
        return runs;
    });
}

RunDetails RunRecords::run(std::int64_t id) const {
    RunDetails details;
    const std::vector<RunSummary> all = runs();
    for (const RunSummary& summary : all)
        if (summary.id == id) details.summary = summary;
    if (details.summary.id != id) {
        const std::string existing = all.empty() ? "there are none" : fmt::format("there are 1 to {}", all.back().id);
        throw Error("there is no run {} in '{}'; {}", id, database_->file, existing);
    }
    return about(database_->file, [&] {
        SQLite::Database& sqlite = database_->sqlite;
        const auto read_fields = [](SQLite::Statement& row, const auto& fields) {
            std::apply([&](auto&... each) { read_row(row, 1, each...); }, fields);
        };
        Selection starts(sqlite, "SELECT seed, " + run_columns + " FROM run WHERE id = ?");
        starts.each(
            [&](SQLite::Statement& row) {
                details.start.seed = std::stoull(row.getColumn(0).getString());
                read_fields(row, fields_of_run(details.start));
            },
            id);

        Selection steps(sqlite, "SELECT id, " + step_columns + " FROM step WHERE run = ? ORDER BY id");
        Selection metrics(sqlite, "SELECT is_fact, name, value, unit FROM metric WHERE step = ? ORDER BY rowid");
        Selection warnings(sqlite, "SELECT text FROM warning WHERE step = ? ORDER BY rowid");
        Selection log(sqlite, "SELECT line FROM log WHERE step = ? ORDER BY rowid");
        const auto add_step = [&](SQLite::Statement& row) {
            StepRecord& step = details.steps.emplace_back();
            read_fields(row, fields_of_step(step));
            const auto add_metric = [&](SQLite::Statement& metric) {
                (metric.getColumn(0).getInt() ? step.properties : step.metrics)
                    .values.push_back(read_metric(metric, 1));
            };
            const std::int64_t step_id = row.getColumn(0).getInt64();
            metrics.each(add_metric, step_id);
            warnings.each([&](auto& text) { step.warnings.push_back(text.getColumn(0).getString()); }, step_id);
            log.each([&](auto& line) { step.log.push_back(line.getColumn(0).getString()); }, step_id);
        };
        steps.each(add_step, id);

        Selection cells(sqlite, "SELECT id, " + cell_columns + " FROM cell WHERE run = ? ORDER BY id");
        Selection nodes(sqlite,
                        "SELECT node FROM cell_step JOIN step ON step.id = cell_step.step WHERE cell = ? "
                        "ORDER BY cell_step.rowid");
        Selection doubts(sqlite, "SELECT text FROM doubt WHERE cell = ? ORDER BY rowid");
        Selection outputs(sqlite, "SELECT id, file, kind, outcome FROM output WHERE cell = ? ORDER BY id");
        Selection properties(sqlite, "SELECT name, value, unit FROM output_fact WHERE output = ? ORDER BY rowid");
        const auto add_cell = [&](SQLite::Statement& row) {
            CellRecord& cell = details.cells.emplace_back();
            read_fields(row, fields_of_cell(cell));
            const auto add_output = [&](SQLite::Statement& found) {
                OutputRecord& output = cell.outputs.emplace_back();
                read_row(found, 1, output.file, output.kind, output.outcome);
                properties.each([&](auto& one) { output.properties.values.push_back(read_metric(one, 0)); },
                                found.getColumn(0).getInt64());
            };
            const std::int64_t cell_id = row.getColumn(0).getInt64();
            nodes.each([&](auto& node) { read_row(node, 0, cell.nodes.emplace_back()); }, cell_id);
            doubts.each([&](auto& text) { cell.doubts.push_back(text.getColumn(0).getString()); }, cell_id);
            outputs.each(add_output, cell_id);
        };
        cells.each(add_cell, id);
        return details;
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
