// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/value.hpp"
#include "scanmill/records/run_records.hpp"

namespace scanmill::runner {

using Json = nlohmann::ordered_json;

namespace {

std::string outcome_of(const RunSummary& run) { return run.outcome.value_or("unfinished"); }

Json to_json(const RunSummary& run) {
    return {
        {"id", run.id},         {"started", run.started},   {"workflow", run.workflow}, {"outcome", outcome_of(run)},
        {"cells", run.cells},   {"doubtful", run.doubtful}, {"failed", run.failed},     {"ran", run.ran},
        {"cached", run.cached}, {"seconds", run.seconds}};
}

Json to_json(const std::vector<std::pair<std::string, std::string>>& pairs) {
    Json json = Json::object();
    for (const auto& [name, value] : pairs) json[name] = value;
    return json;
}

void add_failure(Json& entry, const FailureRecord& failure) {
    if (failure.error.empty()) return;
    entry["error"] = failure.error;
    entry["cause"] = failure.cause;
    if (failure.number != 0) entry["number"] = failure.number;
}

Json to_json(const RunDetails& run) {
    Json json{{"scanmill", 1}, {"run", to_json(run.summary)}, {"cells", Json::array()}, {"steps", Json::array()}};
    json["run"].update({{"file", run.start.file},
                        {"arguments", run.start.arguments},
                        {"seed", run.start.seed},
                        {"threads", run.start.threads},
                        {"version", run.start.version},
                        {"jobs", run.start.jobs},
                        {"machine", run.start.machine},
                        {"libraries", run.start.libraries}});
    for (const CellRecord& cell : run.cells) {
        Json entry{{"scan", cell.scan},       {"workflow", cell.workflow}, {"variant", cell.variant},
                   {"outcome", cell.outcome}, {"seconds", cell.seconds},   {"steps", cell.nodes},
                   {"outputs", Json::array()}};
        if (!cell.doubts.empty()) entry["doubts"] = cell.doubts;
        add_failure(entry, cell.failure);
        for (const OutputRecord& output : cell.outputs)
            entry["outputs"].push_back({{"file", output.file},
                                        {"kind", output.kind},
                                        {"outcome", output.outcome},
                                        {"properties", metrics_json(output.properties)}});
        json["cells"].push_back(std::move(entry));
    }
    for (const StepRecord& step : run.steps) {
        Json entry{{"node", step.node},
                   {"workflow", step.workflow},
                   {"step", step.label},
                   {"filter", step.filter},
                   {"version", step.filter_version},
                   {"build", step.build},
                   {"scan", step.scan},
                   {"key", step.plan_key},
                   {"origin", step.origin},
                   {"why", step.why},
                   {"outcome", step.outcome},
                   {"seconds", step.seconds},
                   {"cpu-seconds", step.cpu_seconds},
                   {"peak-memory", step.peak_memory},
                   {"threads", step.threads},
                   {"attempts", step.attempts},
                   {"authored", to_json(step.authored)},
                   {"parameters", to_json(step.resolved)},
                   {"metrics", metrics_json(step.metrics)},
                   {"properties", metrics_json(step.properties)}};
        add_failure(entry, step.failure);
        if (!step.log.empty()) entry["log"] = step.log;
        if (!step.warnings.empty()) entry["warnings"] = step.warnings;
        json["steps"].push_back(std::move(entry));
    }
    return json;
}

int list_runs(const RunRecords& records, bool json) {
    const std::vector<RunSummary> runs = records.runs();
    if (json) {
        Json all{{"scanmill", 1}, {"runs", Json::array()}};
        for (const RunSummary& run : runs) all["runs"].push_back(to_json(run));
        print_json(all);
        return done;
    }
    Table table(
        {"run", "started", "workflow", "cells", "doubtful", "failed", "computed", "cached", "seconds", "outcome"});
    for (const RunSummary& run : runs)
        table.add({std::to_string(run.id), run.started, run.workflow, std::to_string(run.cells),
                   std::to_string(run.doubtful), std::to_string(run.failed), std::to_string(run.ran),
                   std::to_string(run.cached), fmt::format("{:.2f}", run.seconds), outcome_of(run)});
    fmt::print("{}", table.text());
    return done;
}

int show_run(const RunRecords& records, std::int64_t id, bool json) {
    const RunDetails run = records.run(id);
    if (json) {
        print_json(to_json(run));
        return done;
    }
    fmt::print("run       {} of {}, {}\nworkflow  {}\nversion   {}\nmachine   {}\nthreads   {}, seed {}\n\n", id,
               run.summary.started, outcome_of(run.summary), printable_line(run.start.file), run.start.version,
               printable_line(run.start.machine), run.start.threads, run.start.seed);
    Table cells({"scan", "variant", "outcome", "seconds"});
    for (const CellRecord& cell : run.cells)
        cells.add({cell.scan, cell.variant, cell.outcome, fmt::format("{:.2f}", cell.seconds)});
    fmt::print("{}\n", cells.text());
    Table steps({"scan", "step", "outcome", "seconds", "from", "why"});
    for (const StepRecord& step : run.steps)
        steps.add({step.scan, step.label, step.outcome, fmt::format("{:.2f}", step.seconds), step.origin, step.why});
    fmt::print("{}", steps.text());
    for (const CellRecord& cell : run.cells)
        if (!cell.failure.error.empty()) fmt::print("\n{}\n", printable(cell.failure.error));
    for (const CellRecord& cell : run.cells)
        for (const std::string& doubt : cell.doubts)
            fmt::print("\ndoubt: {}: {}\n", printable_line(cell.scan), printable_line(doubt));
    return done;
}

std::int64_t parse_id(const std::string& text) {
    std::int64_t id = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
    if (error != std::errc() || end != text.data() + text.size()) throw Error("'{}' is not the number of a run", text);
    return id;
}

struct Options {
    std::filesystem::path folder;
    std::string show, id;
    bool json = false;
};

int runs(const Options& options) {
    const RunRecords records = RunRecords::read(options.folder / records_file);
    if (options.show.empty()) return list_runs(records, options.json);
    if (options.id.empty()) throw Error("which run?").hint("scanmill runs DIR show 3; scanmill runs DIR lists them");
    return show_run(records, parse_id(options.id), options.json);
}

}  // namespace

void add_runs(CLI::App& app, Action& chosen) {
    auto [command, options] = add_command<Options>(
        app, chosen, "runs", "Lists the runs recorded in an output folder, or shows one of them", runs);
    command.add_option("DIR", options.folder, "The output folder of the runs")->required();
    command.add_option("show", options.show, "The word `show`, to show one run")->check(CLI::IsMember({"show"}));
    command.add_option("ID", options.id, "The run's number in the list");
    command.add_flag("--json", options.json, "Print it as JSON");
}

}  // namespace scanmill::runner
