// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>

#include "scanmill/records/records_database.hpp"

namespace scanmill {

namespace {

/// One for every version of the tables; a file is brought from its version to the last by those in between.
constexpr std::array<const char*, 2> migrations{R"(
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
)"};

}  // namespace

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
    throw Error("the records '{}' were written by a newer Scanmill: their tables are of version {}, this one knows {}",
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
    const std::filesystem::path target = std::filesystem::weakly_canonical(file, ignored);
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
            throw Error("there are no records '{}'", file.string())
                .hint("name the output folder of a run, the one after -o");
        auto database = std::make_unique<Database>(file, SQLite::OPEN_READONLY);
        const int version = database->version();
        if (version == 0) throw Error("'{}' holds no records of runs", file.string());
        database->require_known(version);
        if (static_cast<std::size_t>(version) < migrations.size()) return append_to(file);  // brings them up to date
        return RunRecords(std::move(database));
    });
}

namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const std::vector<std::pair<std::string, std::string>>& pairs) {
    Json json = Json::object();
    for (const auto& [name, value] : pairs) json[name] = value;
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void bind(SQLite::Statement& statement, int place, double number) {
    if (std::isnan(number))
        statement.bind(place);
    else
        statement.bind(place, number);
}

}  // namespace

std::int64_t RunRecords::begin(const RunStart& start) {
    return about(database_->file, [&] {
        SQLite::Statement insert(
            database_->sqlite,
            "INSERT INTO run (started, workflow, file, arguments, seed, threads, jobs, version, machine, libraries) "
            "VALUES (strftime('%Y-%m-%dT%H:%M:%SZ', 'now'), ?, ?, ?, ?, ?, ?, ?, ?, ?)");
        SQLite::bind(insert, start.workflow, start.file,
                     Json(start.arguments).dump(-1, ' ', false, Json::error_handler_t::replace),
                     std::to_string(start.seed), static_cast<std::int64_t>(start.threads),
                     static_cast<std::int64_t>(start.jobs), start.version, start.machine, start.libraries);
        insert.exec();
        return database_->sqlite.getLastInsertRowid();
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
    SQLite::Statement step_row(
        sqlite,
        "INSERT INTO step (run, node, label, filter, filter_version, build, scan, plan_key, origin, why, outcome, "
        "error, seconds, cpu_seconds, authored, resolved, workflow, cause, cause_number, peak_memory, threads, "
        "attempts) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    SQLite::Statement metric_row(sqlite, "INSERT INTO metric VALUES (?, ?, ?, ?, ?)");
    SQLite::Statement warning_row(sqlite, "INSERT INTO warning VALUES (?, ?)");
    SQLite::Statement log_row(sqlite, "INSERT INTO log VALUES (?, ?)");
    const auto run_row = [](SQLite::Statement& statement) {
        statement.exec();
        statement.reset();
    };
    for (const StepRecord& step : steps) {
        SQLite::bind(step_row, run, static_cast<std::int64_t>(step.node), step.label, step.filter, step.filter_version,
                     step.build, step.scan, step.plan_key, step.origin, step.why, step.outcome, step.failure.error,
                     step.seconds, step.cpu_seconds, text_of(step.authored), text_of(step.resolved), step.workflow,
                     step.failure.cause, step.failure.number, step.peak_memory, static_cast<std::int64_t>(step.threads),
                     static_cast<std::int64_t>(step.attempts));
        run_row(step_row);
        const std::int64_t id = sqlite.getLastInsertRowid();
        database_->step_ids[{run, step.node}] = id;
        for (const Metrics* metrics : {&step.metrics, &step.properties})
            for (const Metric& metric : metrics->values) {
                SQLite::bind(metric_row, id, metrics == &step.properties ? 1 : 0, metric.name);
                bind(metric_row, 4, metric.value);
                metric_row.bind(5, std::string(name_of(metric.unit)));
                run_row(metric_row);
            }
        for (const std::string& text : step.warnings) {
            SQLite::bind(warning_row, id, text);
            run_row(warning_row);
        }
        for (const std::string& line : step.log) {
            SQLite::bind(log_row, id, line);
            run_row(log_row);
        }
    }
    SQLite::Statement cell_row(
        sqlite,
        "INSERT INTO cell (run, scan, variant, outcome, error, seconds, workflow, cause, cause_number) VALUES (?, "
        "?, ?, ?, ?, ?, ?, ?, ?)");
    SQLite::Statement link_row(sqlite, "INSERT INTO cell_step VALUES (?, ?)");
    SQLite::Statement output_row(sqlite, "INSERT INTO output (cell, file, kind, outcome) VALUES (?, ?, ?, ?)");
    SQLite::Statement fact_row(sqlite, "INSERT INTO output_fact VALUES (?, ?, ?, ?)");
    for (const CellRecord& cell : cells) {
        SQLite::bind(cell_row, run, cell.scan, cell.variant, cell.outcome, cell.failure.error, cell.seconds,
                     cell.workflow, cell.failure.cause, cell.failure.number);
        run_row(cell_row);
        const std::int64_t id = sqlite.getLastInsertRowid();
        for (const std::size_t node : cell.nodes)
            if (const auto step = database_->step_ids.find({run, node}); step != database_->step_ids.end()) {
                SQLite::bind(link_row, id, step->second);
                run_row(link_row);
            }
        for (const OutputRecord& output : cell.outputs) {
            SQLite::bind(output_row, id, output.file, output.kind, output.outcome);
            run_row(output_row);
            const std::int64_t output_id = sqlite.getLastInsertRowid();
            for (const Metric& fact : output.properties.values) {
                SQLite::bind(fact_row, output_id, fact.name);
                bind(fact_row, 3, fact.value);
                fact_row.bind(4, std::string(name_of(fact.unit)));
                run_row(fact_row);
            }
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
        SQLite::bind(ending, run, outcome, seconds);
        ending.exec();
        transaction.commit();
    });
}

namespace {

using Json = nlohmann::ordered_json;

std::vector<std::pair<std::string, std::string>> pairs_of(const std::string& text) {
    std::vector<std::pair<std::string, std::string>> pairs;
    const Json json = Json::parse(text, nullptr, false);
    for (const auto& [name, value] : json.items())
        if (value.is_string()) pairs.emplace_back(name, value.get<std::string>());
    return pairs;
}

Metric metric_from(SQLite::Statement& row, int first) {
    const SQLite::Column value = row.getColumn(first + 1);
    return {row.getColumn(first).getString(), value.isNull() ? std::nan("") : value.getDouble(),
            unit_named(row.getColumn(first + 2).getString()).value_or(Unit::number)};
}

}  // namespace

std::vector<RunSummary> RunRecords::runs() const {
    return about(database_->file, [&] {
        SQLite::Statement row(
            database_->sqlite,
            "SELECT run.id, started, workflow, run_end.outcome, COALESCE(run_end.seconds, 0), "
            "(SELECT COUNT(*) FROM cell WHERE cell.run = run.id), "
            "(SELECT COUNT(*) FROM cell WHERE cell.run = run.id AND outcome = 'failed'), "
            "(SELECT COUNT(DISTINCT node) FROM step WHERE step.run = run.id AND origin = 'ran'), "
            // What was taken over and then had to run all the same counts as run.
            "(SELECT COUNT(DISTINCT node) FROM step WHERE step.run = run.id AND origin != 'ran' AND node NOT IN "
            "(SELECT node FROM step WHERE step.run = run.id AND origin = 'ran')) "
            "FROM run LEFT JOIN run_end ON run_end.run = run.id ORDER BY run.id");
        const auto count = [&row](int column) { return static_cast<std::size_t>(row.getColumn(column).getInt64()); };
        std::vector<RunSummary> runs;
        while (row.executeStep()) {
            RunSummary summary;
            summary.id = row.getColumn(0).getInt64();
            summary.started = row.getColumn(1).getString();
            summary.workflow = row.getColumn(2).getString();
            if (!row.getColumn(3).isNull()) summary.outcome = row.getColumn(3).getString();
            summary.seconds = row.getColumn(4).getDouble();
            summary.cells = count(5);
            summary.failed = count(6);
            summary.ran = count(7);
            summary.cached = count(8);
            runs.push_back(std::move(summary));
        }
        return runs;
    });
}

RunDetails RunRecords::run(std::int64_t id) const {
    RunDetails details;
    const std::vector<RunSummary> all = runs();
    for (const RunSummary& summary : all)
        if (summary.id == id) details.summary = summary;
    if (details.summary.id != id) {
        const std::string known = all.empty() ? "there are none" : fmt::format("there are 1 to {}", all.back().id);
        throw Error("there is no run {} in '{}'; {}", id, database_->file, known);
    }
    return about(database_->file, [&] {
        SQLite::Database& sqlite = database_->sqlite;
        SQLite::Statement start(sqlite,
                                "SELECT file, arguments, seed, threads, version, machine, jobs, libraries FROM run "
                                "WHERE id = ?");
        start.bind(1, id);
        start.executeStep();
        details.start.workflow = details.summary.workflow;
        details.start.file = start.getColumn(0).getString();
        for (const Json& word : Json::parse(start.getColumn(1).getString(), nullptr, false))
            if (word.is_string()) details.start.arguments.push_back(word.get<std::string>());
        details.start.seed = std::stoull(start.getColumn(2).getString());
        details.start.threads = static_cast<unsigned>(start.getColumn(3).getInt64());
        details.start.version = start.getColumn(4).getString();
        details.start.machine = start.getColumn(5).getString();
        details.start.jobs = static_cast<unsigned>(start.getColumn(6).getInt64());
        details.start.libraries = start.getColumn(7).getString();

        SQLite::Statement steps(sqlite,
                                "SELECT id, node, label, filter, filter_version, build, scan, plan_key, origin, why, "
                                "outcome, error, seconds, cpu_seconds, authored, resolved, workflow, cause, "
                                "cause_number, COALESCE(peak_memory, 0), threads, attempts FROM step WHERE run = ? "
                                "ORDER BY id");
        SQLite::Statement metrics(sqlite,
                                  "SELECT is_fact, name, value, unit FROM metric WHERE step = ? ORDER BY rowid");
        SQLite::Statement warnings(sqlite, "SELECT text FROM warning WHERE step = ? ORDER BY rowid");
        SQLite::Statement log(sqlite, "SELECT line FROM log WHERE step = ? ORDER BY rowid");
        steps.bind(1, id);
        while (steps.executeStep()) {
            StepRecord step;
            const auto text = [&steps](int column) { return steps.getColumn(column).getString(); };
            step.node = static_cast<std::size_t>(steps.getColumn(1).getInt64());
            step.label = text(2);
            step.filter = text(3);
            step.filter_version = steps.getColumn(4).getInt();
            step.build = text(5);
            step.scan = text(6);
            step.plan_key = text(7);
            step.origin = text(8);
            step.why = text(9);
            step.outcome = text(10);
            step.failure = {text(17), steps.getColumn(18).getInt(), text(11)};
            step.seconds = steps.getColumn(12).getDouble();
            step.cpu_seconds = steps.getColumn(13).getDouble();
            step.authored = pairs_of(text(14));
            step.resolved = pairs_of(text(15));
            step.workflow = text(16);
            step.peak_memory = steps.getColumn(19).getInt64();
            step.threads = static_cast<unsigned>(steps.getColumn(20).getInt64());
            step.attempts = static_cast<unsigned>(steps.getColumn(21).getInt64());
            metrics.bind(1, steps.getColumn(0).getInt64());
            while (metrics.executeStep())
                (metrics.getColumn(0).getInt() ? step.properties : step.metrics)
                    .values.push_back(metric_from(metrics, 1));
            metrics.reset();
            warnings.bind(1, steps.getColumn(0).getInt64());
            while (warnings.executeStep()) step.warnings.push_back(warnings.getColumn(0).getString());
            warnings.reset();
            log.bind(1, steps.getColumn(0).getInt64());
            while (log.executeStep()) step.log.push_back(log.getColumn(0).getString());
            log.reset();
            details.steps.push_back(std::move(step));
        }

        SQLite::Statement cells(
            sqlite,
            "SELECT id, scan, variant, outcome, error, seconds, workflow, cause, cause_number FROM cell WHERE run = ? "
            "ORDER BY id");
        SQLite::Statement nodes(sqlite,
                                "SELECT node FROM cell_step JOIN step ON step.id = cell_step.step WHERE cell = ? "
                                "ORDER BY cell_step.rowid");
        SQLite::Statement outputs(sqlite, "SELECT id, file, kind, outcome FROM output WHERE cell = ? ORDER BY id");
        SQLite::Statement properties(sqlite,
                                     "SELECT name, value, unit FROM output_fact WHERE output = ? ORDER BY rowid");
        cells.bind(1, id);
        while (cells.executeStep()) {
            CellRecord cell{
                cells.getColumn(6).getString(),
                cells.getColumn(1).getString(),
                cells.getColumn(2).getString(),
                cells.getColumn(3).getString(),
                {cells.getColumn(7).getString(), cells.getColumn(8).getInt(), cells.getColumn(4).getString()},
                cells.getColumn(5).getDouble(),
                {},
                {}};
            nodes.bind(1, cells.getColumn(0).getInt64());
            while (nodes.executeStep()) cell.nodes.push_back(static_cast<std::size_t>(nodes.getColumn(0).getInt64()));
            nodes.reset();
            outputs.bind(1, cells.getColumn(0).getInt64());
            while (outputs.executeStep()) {
                OutputRecord output{outputs.getColumn(1).getString(),
                                    outputs.getColumn(2).getString(),
                                    outputs.getColumn(3).getString(),
                                    {}};
                properties.bind(1, outputs.getColumn(0).getInt64());
                while (properties.executeStep()) output.properties.values.push_back(metric_from(properties, 0));
                properties.reset();
                cell.outputs.push_back(std::move(output));
            }
            outputs.reset();
            details.cells.push_back(std::move(cell));
        }
        return details;
    });
}

std::vector<PastStep> RunRecords::last_steps(const std::string& workflow, const std::string& scan,
                                             const std::string& label) const {
    return about(database_->file, [&] {
        SQLite::Statement row(
            database_->sqlite,
            "SELECT run.id, seed, filter, build, plan_key, filter_version, authored, outcome FROM step JOIN run ON "
            "run.id = step.run WHERE step.run = "
            "(SELECT MAX(run) FROM step WHERE step.workflow = ?1 AND scan = ?2 AND label = ?3) "
            "AND step.workflow = ?1 AND scan = ?2 AND label = ?3 ORDER BY step.id");
        SQLite::bind(row, workflow, scan, label);
        std::vector<PastStep> steps;
        while (row.executeStep())
            steps.push_back({row.getColumn(0).getInt64(), std::stoull(row.getColumn(1).getString()),
                             row.getColumn(2).getString(), row.getColumn(3).getString(), row.getColumn(4).getString(),
                             row.getColumn(5).getInt(), pairs_of(row.getColumn(6).getString()),
                             row.getColumn(7).getString() == "done"});
        return steps;
    });
}

}  // namespace scanmill
