// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "output/comparison_text.hpp"
#include "output/page_file.hpp"
#include "output/reproduce.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/compare/formats.hpp"
#include "scanmill/compare/recorded.hpp"

namespace scanmill::runner {

namespace {

struct Options {
    std::filesystem::path folder;
    std::string against, who, why, metric, format = "text", table;
    std::optional<std::int64_t> run;
    std::optional<unsigned> jobs;
    std::string acknowledge, sheet;
    std::filesystem::path html;
    bool accept = false, revoke = false, strict = false, json = false;
};

bool is_blank(const std::string& text) { return text.find_first_not_of(" \t\n") == std::string::npos; }

/// Throws Error unless both --who and --why are given.
void require_reason(const Options& options) {
    const std::string action = options.accept ? "--accept" : options.revoke ? "--revoke" : "--acknowledge CELL";
    if (!is_blank(options.who) && !is_blank(options.why)) return;
    throw Error("{} needs a name and a reason, which are recorded", action)
        .hint(fmt::format("scanmill report {} {} --who NAME --why TEXT", shell_word(options.folder), action));
}

int accept(const Options& options) {
    const RecordedRun which{options.folder, options.run};
    RunRecords records = records_to_change(options.folder);
    const std::int64_t id = ended_run(records, which);
    const RunSummary run = records.summary(id);
    records.accept(id, options.who, options.why);
    if (run.failed > 0)
        print_warning(fmt::format("{} of run {} failed; the gate does not compare them",
                                  count_text(run.failed, "cell", "cells"), id));
    fmt::print("run {} is the accepted run of {}\n", id, printable_line(run.workflow));
    return done;
}

int revoke(const Options& options) {
    const RecordedRun which{options.folder, options.run};
    RunRecords records = records_to_change(options.folder);
    const std::string batch = records.summary(ended_run(records, which)).workflow;
    records.revoke(batch, options.who, options.why);
    if (const auto before = records.baseline(batch))
        fmt::print("run {} is the accepted run of {} again\n", before->run, printable_line(batch));
    else
        fmt::print("no run of {} is accepted now\n", printable_line(batch));
    return done;
}

/// "scans/a.ply [fine]": a cell as --acknowledge takes it.
std::string cell_name(const CellComparison& cell) { return fmt::format("{} [{}]", cell.scan, cell.variant); }

/// Acknowledges the present doubts of the cells that the option names: a scan, or a scan with a variant.
int acknowledge(const Options& options) {
    const Comparison comparison = compare_recorded({options.folder, options.run}, std::nullopt, {});
    std::vector<const CellComparison*> chosen;
    std::vector<std::string> doubtful;
    bool is_cell = false;
    for (const CellComparison& cell : comparison.cells) {
        const bool is_named = cell.scan == options.acknowledge || cell_name(cell) == options.acknowledge;
        is_cell = is_cell || is_named;
        if (cell.doubts.empty()) continue;
        doubtful.push_back(cell_name(cell));
        if (is_named) chosen.push_back(&cell);
    }
    if (chosen.empty()) {
        const std::string hint =
            doubtful.empty() ? "no cell of the run has doubts" : "cells with doubts are " + enumerated(doubtful);
        throw is_cell
            ? Error("the cell '{}' of run {} has no doubts", options.acknowledge, comparison.run.id).hint(hint)
            : Error("run {} has no cell '{}'{}", comparison.run.id, options.acknowledge,
                    did_you_mean(options.acknowledge, doubtful))
                  .hint(hint);
    }
    RunRecords records = records_to_change(options.folder);
    for (const CellComparison* cell : chosen) {
        records.acknowledge(
            {comparison.batch, cell->workflow, cell->scan, cell->variant, "", options.who, options.why, cell->doubts});
        fmt::print("{} of {} {} known now\n", count_text(cell->doubts.size(), "doubt", "doubts"),
                   printable_line(cell_name(*cell)), by_count(cell->doubts.size(), "is", "are"));
    }
    return done;
}

/// Throws Error unless a cell has the metric.
void require_metric(const std::string& metric, const Comparison& comparison) {
    const std::vector<std::string> names = metric_names(comparison);
    if (std::ranges::find(names, metric) == names.end())
        throw Error("no cell has the metric '{}'{}", metric, did_you_mean(metric, names))
            .hint("there are " + enumerated(names));
}

int report(const Options& options) {
    if (options.accept || options.revoke || !options.acknowledge.empty()) {
        require_reason(options);
        return options.accept ? accept(options) : options.revoke ? revoke(options) : acknowledge(options);
    }
    if (!options.who.empty() || !options.why.empty())
        throw Error("--who and --why are for --accept, --revoke and --acknowledge").hint("scanmill report --help");
    const RecordedRun which{options.folder, options.run};
    if (!options.table.empty()) {
        write_csv(which, [](const std::string& text) { std::fwrite(text.data(), 1, text.size(), stdout); });
        return done;
    }
    const auto against = options.against.empty() ? std::nullopt : std::optional(RecordedRun::parse(options.against));
    if (!options.sheet.empty()) {
        write_sheet_file(options.html, which, options.sheet, options.jobs);
        return exit_code_of(compare_recorded(which, std::nullopt, {}), options.strict);
    }
    if (!options.html.empty()) write_page_file(options.html, which, against, options.jobs);
    const Comparison comparison = compare_recorded(which, against, reproducing_command);
    if (!options.metric.empty()) require_metric(options.metric, comparison);
    if (!options.html.empty()) return exit_code_of(comparison, options.strict);
    if (options.json)
        print_json(report_json(comparison));
    else
        fmt::print("{}",
                   options.format == "junit" ? junit_xml(comparison, options.strict)
                   : options.format == "markdown"
                       ? markdown(comparison, options.metric.empty() ? default_metric(comparison) : options.metric)
                       : comparison_text(comparison, options.folder, options.metric, stdout_width()));
    return exit_code_of(comparison, options.strict);
}

}  // namespace

void add_report(CLI::App& app, Action& chosen) {
    auto [command, options] =
        add_command<Options>(app, chosen, "report",
                             "Compares a recorded run with the accepted one; exits with 4 if the gate tripped", report);
    command.add_option("DIR", options.folder, "The output folder of the runs")->required();
    CLI::Option* against =
        command.add_option("--against", options.against,
                           "The run to compare with. DIR: the accepted run of that folder, or its last run if none is "
                           "accepted; DIR:RUN: that run. Default: the accepted run in the same folder");
    command.add_option("--run", options.run,
                       "The run's number in `scanmill runs DIR`. Default: the last run that ended");
    CLI::Option* accept = command.add_flag("--accept", options.accept,
                                           "Accept the run: later runs are compared with it; needs --who and --why");
    CLI::Option* revoke =
        command.add_flag("--revoke", options.revoke, "Revoke the last acceptance; needs --who and --why");
    CLI::Option* acknowledge = command.add_option(
        "--acknowledge", options.acknowledge,
        "Record that the present doubts of a cell are known, SCAN or 'SCAN [VARIANT]'; needs --who and --why. While "
        "they are unchanged, the cell is not doubtful in reports");
    command.add_option("--who", options.who, "Name of the person who accepts, revokes or acknowledges; it is recorded");
    command.add_option("--why", options.why, "The reason; it is recorded");
    CLI::Option* metric =
        command.add_option("--metric", options.metric,
                           "Print a table of this metric, with a row per scan and a column per variant: NAME, "
                           "STEP.NAME, seconds, cpu-seconds or memory");
    CLI::Option* format = command.add_option("--format", options.format, "Print text, junit (XML) or markdown")
                              ->check(CLI::IsMember({"text", "junit", "markdown"}));
    CLI::Option* table =
        command
            .add_option("--table", options.table,
                        "Print all numbers of all cells as csv, for all ended runs or for --run, without a verdict")
            ->check(CLI::IsMember({"csv"}));
    CLI::Option* html = command.add_option(
        "--html", options.html,
        "Write the report as one HTML file with pictures, which opens from disk. Previews are kept in DIR/previews");
    CLI::Option* sheet = command.add_option("--sheet", options.sheet,
                                            "Write inspected parts to the file of --html, an A4 page each, instead of "
                                            "the report: a scan, 'SCAN [VARIANT]', "
                                            "a folder of scans, or . for all parts of the run");
    sheet->needs(html)->check(CLI::Validator(
        [](const std::string& parts) { return parts.empty() ? "the name of the parts is empty" : std::string(); }, ""));
    command
        .add_option(
            "-j,--jobs", options.jobs,
            "Number of worker processes that make previews; 0: they are made in the command's process. Default: the "
            "number of cores")
        ->needs(html)
        ->check(CLI::Range(0u, most_jobs));
    command.add_flag("--strict", options.strict, "Exit with 1 if a result is doubtful");
    CLI::Option* json = command.add_flag("--json", options.json, "Print the result as JSON");
    format->excludes(json);
    for (CLI::Option* other : {metric, format, table, json}) html->excludes(other);
    for (CLI::Option* other : {against, metric, format, json}) table->excludes(other);
    accept->excludes(revoke);
    acknowledge->excludes(accept)->excludes(revoke);
    sheet->excludes(against);
    for (CLI::Option* action : {accept, revoke, acknowledge})
        for (CLI::Option* other : {against, metric, format, table, json, html}) action->excludes(other);
}

}  // namespace scanmill::runner
