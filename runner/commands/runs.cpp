// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "output/comparison_text.hpp"
#include "output/reproduce.hpp"
#include "output/run_table.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/compare/recorded.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/records/run_records.hpp"
#include "scanmill/report/documents.hpp"
#include "scanmill/session/merge_runs.hpp"
#include "scanmill/session/output_lock.hpp"
#include "scanmill/session/prune.hpp"

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
    std::map<std::int64_t, RunBytes> bytes = bytes_by_run(records);
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
    ListedRun listed{run, was_killed(folder, run), {}, 0, 0};
    if (const auto size = folder.bytes.find(run.id); size != folder.bytes.end()) {
        listed.bytes = size->second.bytes;
        listed.gone = size->second.gone;
    }
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

/// "1.2 MB", or "1.2 MB, 3 gone" if files that the run wrote are gone.
std::string size_text(const Folder& folder, const RunSummary& run) {
    const auto found = folder.bytes.find(run.id);
    if (found == folder.bytes.end()) return "-";
    const auto& [bytes, gone] = found->second;
    return byte_size_text(bytes) + (gone > 0 ? fmt::format(", {} gone", gone) : "");
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
                                     "regressions", "computed", "cached",   "seconds", "takes",    "outcome"};
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
                                     size_text(folder, run),
                                     outcome_of(folder, run)};
        if (!folder.acceptances.empty()) row.push_back(accepted_text(folder, run));
        table.add(std::move(row));
    }
    table.may_cut("workflow");
    if (!folder.acceptances.empty()) table.may_cut("accepted");
    for (const char* name : {"cached", "computed", "seconds", "started"}) table.may_leave_out(name);
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

/// "1 to 4, 7": the numbers in ascending order; "none" without numbers.
std::string numbers_text(const std::vector<std::int64_t>& numbers) {
    std::string text;
    for (std::size_t begin = 0, end = 0; begin < numbers.size(); begin = end) {
        for (end = begin + 1; end < numbers.size() && numbers[end] == numbers[end - 1] + 1;) ++end;
        text += (text.empty() ? "" : ", ") + std::to_string(numbers[begin]) +
                (end > begin + 1 ? fmt::format(" to {}", numbers[end - 1]) : "");
    }
    return text.empty() ? "none" : text;
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
    std::optional<std::int64_t> keep;
    bool json = false, prunes = false, dry_run = false, merges = false;
    std::vector<std::filesystem::path> shards;  ///< for `merge`
    std::filesystem::path output;
    std::vector<std::string> command_line;
};

/// Prints the verdict of the gate on a merged run, records it, and returns the exit code.
int judge(const std::filesystem::path& folder, std::int64_t run, bool prints) {
    const RunSummary summary = RunRecords::read(folder / records_file).summary(run);
    const int code = summary.failed > 0 ? some_failed : done;
    const std::optional<Comparison> comparison = verdict_of_batch(folder, run, reproducing_command);
    if (!comparison) return code;
    if (!comparison->gate.rules.empty())
        records_to_change(folder).add_verdict(run, comparison->count(Verdict::regressed));
    if (prints) fmt::print("{}", verdict_text(*comparison, folder));
    return std::max<int>(code, exit_code_of(*comparison, false));
}

int merge(const Options& options) {
    const MergedRuns merged = merge_runs(options.shards, options.output, options.command_line, print_warning);
    if (options.json) {
        print_document(json_of(MergedDocument{merged.run, merged.shards, merged.cells, merged.moved, merged.copied}));
        return judge(options.output, merged.run, false);
    }
    fmt::print("run {} of {} has {} of {}; {} moved, {} copied\n", merged.run,
               printable_line(shown_path(options.output)), count_text(merged.cells, "cell", "cells"),
               count_text(merged.shards, "shard", "shards"), count_text(merged.moved, "file was", "files were"),
               merged.copied);
    return judge(options.output, merged.run, true);
}

int prune_runs(const Options& options) {
    if (!options.show.empty()) throw Error("--prune removes runs, and `show` prints one").hint("give one of them");
    if (!options.keep || *options.keep < 1)
        throw Error("--prune needs the number of runs to keep, at least 1")
            .hint("scanmill runs DIR --prune --keep 30 keeps the newest 30 runs of every workflow and batch");
    const Pruned pruned = prune(options.folder, static_cast<std::size_t>(*options.keep), options.dry_run,
                                options.command_line, print_warning);
    if (options.json) {
        PrunedDocument document{pruned.runs,         {}, pruned.bytes, pruned.preview_bytes, pruned.records_before,
                                pruned.records_after};
        for (const std::filesystem::path& file : pruned.files) document.files.push_back(file.string());
        print_document(json_of(document));
        return done;
    }
    if (options.dry_run)
        for (const std::filesystem::path& file : pruned.files) fmt::print("{}\n", printable_line(shown_path(file)));
    fmt::print("{} {} ({}) and {} ({})\n", options.dry_run ? "would remove" : "removed",
               count_text(pruned.runs.size(), "run", "runs"), numbers_text(pruned.runs),
               count_text(pruned.files.size(), "file", "files"), byte_size_text(pruned.bytes));
    if (pruned.preview_bytes > 0)
        fmt::print("{} previews for pages ({})\n", options.dry_run ? "would remove" : "removed",
                   byte_size_text(pruned.preview_bytes));
    if (!options.dry_run && !pruned.runs.empty())
        fmt::print("the records had {}, and have {}\n", byte_size_text(pruned.records_before),
                   byte_size_text(pruned.records_after));
    if (pruned.changed > 0)
        fmt::print("{} of these runs {}, because something else changed {} since\n",
                   count_text(pruned.changed, "file", "files"), by_count(pruned.changed, "stays", "stay"),
                   by_count(pruned.changed, "it", "them"));
    if (pruned.read > 0)
        fmt::print("{} of these runs {}, because runs that stay read files of {}\n",
                   count_text(pruned.read, "file", "files"), by_count(pruned.read, "stays", "stay"),
                   by_count(pruned.read, "its name", "their names"));
    if (pruned.outside > 0)
        fmt::print("{} outside the folder {}\n", count_text(pruned.outside, "file", "files"),
                   by_count(pruned.outside, "stays", "stay"));
    return done;
}

int runs(const Options& options) {
    if (options.merges) return merge(options);
    if (options.folder.empty())
        throw Error("the output folder of the runs is missing").hint("scanmill runs DIR lists the runs in DIR");
    if (options.prunes) return prune_runs(options);
    if (options.keep || options.dry_run)
        throw Error("{} is for --prune", options.keep ? "--keep" : "--dry-run")
            .hint("scanmill runs DIR --prune --keep 30");
    Folder folder(options.folder);
    if (options.show.empty()) return list_runs(folder, options.json);
    if (options.id.empty())
        throw Error("`show` needs the number of a run")
            .hint("scanmill runs DIR show 3 shows run 3; scanmill runs DIR lists the runs");
    return show_run(folder, parse_id(options.id), options.json);
}

}  // namespace

void add_runs(CLI::App& app, Action& chosen, const std::vector<std::string>& command_line) {
    auto [command, options] = add_command<Options>(
        app, chosen, "runs", "Lists the runs recorded in an output folder, or shows one of them", runs);
    command.add_option("DIR", options.folder, "The output folder of the runs");
    command.add_option("show", options.show, "The word `show`, to show one run")->check(CLI::IsMember({"show"}));
    command.add_option("ID", options.id, "The run's number in the list");
    command.add_flag(
        "--prune", options.prunes,
        "Remove old runs from the records, and the files that only they wrote; needs --keep. Accepted runs "
        "stay");
    command.add_option("--keep", options.keep, "How many runs of every workflow and batch --prune keeps, the newest");
    command.add_flag("--dry-run", options.dry_run, "Print what --prune would remove, and remove nothing");
    options.command_line = command_line;
    command.add_flag("--json", options.json, "Print the result as JSON");

    CLI::App* merging = command.add_subcommand(
        "merge", "Makes one run of the shards of a batch, and moves their outputs into one folder");
    Options& merge_options = options;
    merging->callback([&merge_options] { merge_options.merges = true; });
    merging->add_option("DIR", merge_options.shards, "The output folders of all shards (batch --shard)")->required();
    merging->add_option("-o,--output", merge_options.output, "The output folder of the whole run")->required();
    merging->add_flag("--json", merge_options.json, "Print the result as JSON");
}

}  // namespace scanmill::runner
