// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "scanmill/records/records_database.hpp"

namespace scanmill {

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
        for (const Metrics* metrics : {&step.metrics, &step.facts})
            for (const Metric& metric : metrics->values) {
                SQLite::bind(metric_row, id, metrics == &step.facts ? 1 : 0, metric.name);
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
            for (const Metric& fact : output.facts.values) {
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

}  // namespace scanmill
