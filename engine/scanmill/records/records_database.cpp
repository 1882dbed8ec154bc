// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/records/records_database.hpp"

#include <array>

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

RunRecords RunRecords::append_to(const std::filesystem::path& file) {
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

}  // namespace scanmill
