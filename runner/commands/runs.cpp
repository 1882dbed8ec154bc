// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>

#include "commands/commands.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/records/run_records.hpp"
#include "scanmill/report/documents.hpp"
#include "scanmill/session/output_lock.hpp"

namespace scanmill::runner {

namespace {

/// The records of a folder, its acceptances, and whether a run is still going on in it.
struct Folder {
    explicit Folder(const std::filesystem::path& folder)
        : records(RunRecords::read(folder / records_file)),
          acceptances(records.acceptances()),
          is_in_use(OutputLock::is_held(folder)) {}

    RunRecords records;
    std::vector<Acceptance> acceptances;
    bool is_in_use;
    std::optional<std::int64_t> running{};  ///< the run that is still going on
};

/// Whether the run was killed: it has no end, and it is not the run that is still going on.
bool was_killed(const Folder& folder, const RunSummary& run) { return !run.outcome && folder.running != run.id; }

std::string outcome_of(const Folder& folder, const RunSummary& run) {
    return run.outcome ? *run.outcome : was_killed(folder, run) ? "interrupted" : "running";
}

bool is_baseline(const Folder& folder, const Acceptance& acceptance, const std::string& batch) {
    const std::optional<Acceptance> held = folder.records.baseline(batch);
    return held && held->id == acceptance.id;
}

ListedRun listed(const Folder& folder, const RunSummary& run) {
    ListedRun listed{run, was_killed(folder, run), {}};
    listed.summary.outcome = outcome_of(folder, run);
    for (const Acceptance& acceptance : folder.acceptances) {
        if (acceptance.run != run.id) continue;
        AcceptanceDocument document{
            acceptance.at, acceptance.who, acceptance.why, is_baseline(folder, acceptance, run.workflow), {}};
        if (acceptance.revoked_at)
            document.revoked = {*acceptance.revoked_at, acceptance.revoked_by, acceptance.revoked_why};
        listed.accepted.push_back(std::move(document));
    }
    return listed;
}

void print_document(const Json& members) {
    Json json{{"scanmill", 1}};
    json.update(members);
    print_json(json);
}

/// "baseline, by ann: the new mesher" for each acceptance of the run; empty without acceptances.
std::string accepted_text(const Folder& folder, const RunSummary& run) {
    std::string text;
    for (const Acceptance& acceptance : folder.acceptances) {
        if (acceptance.run != run.id) continue;
        text += fmt::format("{}{}by {}: {}", text.empty() ? "" : "; ",
                            is_baseline(folder, acceptance, run.workflow) ? "baseline, " : "", acceptance.who,
                            acceptance.why);
        if (acceptance.revoked_at)
            text += fmt::format(" (revoked by {}: {})", acceptance.revoked_by, acceptance.revoked_why);
    }
    return text;
}

using Variants = std::map<std::size_t, std::vector<std::string>>;

/// The variants that use each step, by the step's node. Cells are recorded when they end, so a killed run may lack
/// some.
Variants variants_of(const RunDetails& run) {
    Variants variants;
    for (const CellRecord& cell : run.cells)
        for (const std::size_t node : cell.nodes) {
            std::vector<std::string>& names = variants[node];
            if (std::ranges::find(names, cell.variant) == names.end()) names.push_back(cell.variant);
        }
    return variants;
}

/// Lists at most three names.
std::string names_text(const std::vector<std::string>& names) {
    constexpr std::size_t most = 3;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), most); ++i) text += (i == 0 ? "" : ", ") + names[i];
    return names.size() > most ? fmt::format("{} and {} more", text, names.size() - most) : text;
}

int list_runs(Folder& folder, bool json) {
    const std::vector<RunSummary> runs = folder.records.runs();
    if (folder.is_in_use && !runs.empty()) folder.running = runs.back().id;
    if (json) {
        RunsDocument document;
        for (const RunSummary& run : runs) document.runs.push_back(listed(folder, run));
        print_document(json_of(document));
        return done;
    }
    std::vector<std::string> headers{"run",         "started",  "workflow", "cells",   "doubtful", "failed",
                                     "regressions", "computed", "cached",   "seconds", "outcome"};
    if (!folder.acceptances.empty()) headers.push_back("accepted");
    Table table(headers);
    for (const RunSummary& run : runs) {
        std::vector<std::string> row{std::to_string(run.id),
                                     run.started,
                                     run.workflow,
                                     std::to_string(run.cells),
                                     std::to_string(run.doubtful),
                                     std::to_string(run.failed),
                                     run.regressions ? std::to_string(*run.regressions) : "-",
                                     std::to_string(run.ran),
                                     std::to_string(run.cached),
                                     fmt::format("{:.2f}", run.seconds),
                                     outcome_of(folder, run)};
        if (!folder.acceptances.empty()) row.push_back(accepted_text(folder, run));
        table.add(std::move(row));
    }
    table.may_cut("workflow");
    fmt::print("{}", table.text(stdout_width()));
    return done;
}

int show_run(Folder& folder, std::int64_t id, bool json) {
    const RunDetails run = folder.records.run(id);
    if (folder.is_in_use && folder.records.runs().back().id == id) folder.running = id;
    if (json) {
        print_document(json_of(ShownRunDocument{{listed(folder, run.summary), run.start}, run.cells, run.steps}));
        return done;
    }
    fmt::print("run       {} of {}, {}\nworkflow  {}\nversion   {}\nmachine   {}\nthreads   {}, seed {}\n", id,
               run.summary.started, outcome_of(folder, run.summary), printable_line(run.start.file), run.start.version,
               printable_line(run.start.machine), run.start.threads, run.start.seed);
    if (const std::string accepted = accepted_text(folder, run.summary); !accepted.empty())
        fmt::print("accepted  {}\n", printable_line(accepted));
    fmt::print("\n");
    const Variants variants = variants_of(run);
    const auto variants_text = [&](const StepRecord& step) {
        const auto used = variants.find(step.node);
        return used == variants.end() ? "-" : names_text(used->second);
    };
    Table cells({"scan", "variant", "outcome", "seconds"});
    for (const CellRecord& cell : run.cells)
        cells.add({cell.scan, cell.variant, std::string(name_of(cell.outcome)), fmt::format("{:.2f}", cell.seconds)});
    cells.may_cut("scan");
    fmt::print("{}\n", cells.text(stdout_width()));
    Table steps({"scan", "step", "variants", "outcome", "seconds", "from", "why"});
    for (const StepRecord& step : run.steps)
        steps.add({step.scan, step.label, variants_text(step), std::string(name_of(step.outcome)),
                   fmt::format("{:.2f}", step.effort.seconds), std::string(name_of(step.origin)), step.why});
    steps.may_cut("scan");
    steps.may_cut("why");
    fmt::print("{}", steps.text(stdout_width()));
    std::map<std::pair<std::string, std::string>, std::vector<std::string>> failed;  // scan and error → variants
    for (const CellRecord& cell : run.cells)
        if (cell.failure) failed[{cell.scan, cell.failure.error}].push_back(cell.variant);
    for (const auto& [failure, names] : failed)
        fmt::print("\n{} [{}]: {}\n", printable_line(failure.first), printable_line(names_text(names)),
                   printable(failure.second));
    for (const CellRecord& cell : run.cells)
        for (const OutputRecord& output : cell.outputs)
            if (!output.evidence.empty())
                fmt::print("\n{} [{}]: the failed result was written to '{}'\n", printable_line(cell.scan),
                           printable_line(cell.variant), printable_line(output.evidence));
    for (const CellRecord& cell : run.cells)
        for (const OutputRecord& output : cell.outputs)
            if (!output.moved_to.empty())
                fmt::print("\n{} [{}]: the output of an earlier run was moved to '{}'\n", printable_line(cell.scan),
                           printable_line(cell.variant), printable_line(output.moved_to));
    for (const CellRecord& cell : run.cells)
        for (const std::string& doubt : cell.doubts)
            fmt::print("\ndoubt: {} [{}]: {}\n", printable_line(cell.scan), printable_line(cell.variant),
                       printable_line(doubt));
    for (const StepRecord& step : run.steps)
        for (const std::string& warning : step.warnings)
            fmt::print("\nwarning: {} [{}]: {}: {}\n", printable_line(step.scan), printable_line(variants_text(step)),
                       printable_line(step.label), printable_line(warning));
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
    Folder folder(options.folder);
    if (options.show.empty()) return list_runs(folder, options.json);
    if (options.id.empty())
        throw Error("`show` needs the number of a run")
            .hint("scanmill runs DIR show 3 shows run 3; scanmill runs DIR lists the runs");
    return show_run(folder, parse_id(options.id), options.json);
}

}  // namespace

void add_runs(CLI::App& app, Action& chosen) {
    auto [command, options] = add_command<Options>(
        app, chosen, "runs", "Lists the runs recorded in an output folder, or shows one of them", runs);
    command.add_option("DIR", options.folder, "The output folder of the runs")->required();
    command.add_option("show", options.show, "The word `show`, to show one run")->check(CLI::IsMember({"show"}));
    command.add_option("ID", options.id, "The run's number in the list");
    command.add_flag("--json", options.json, "Print the result as JSON");
}

}  // namespace scanmill::runner
