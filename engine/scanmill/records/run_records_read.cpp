// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "scanmill/records/records_database.hpp"

namespace scanmill {

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
                (metrics.getColumn(0).getInt() ? step.facts : step.metrics).values.push_back(metric_from(metrics, 1));
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
        SQLite::Statement facts(sqlite, "SELECT name, value, unit FROM output_fact WHERE output = ? ORDER BY rowid");
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
                facts.bind(1, outputs.getColumn(0).getInt64());
                while (facts.executeStep()) output.facts.values.push_back(metric_from(facts, 0));
                facts.reset();
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
