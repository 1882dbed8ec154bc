// SPDX-License-Identifier: GPL-3.0-or-later
// The command `export`: scripts that run a batch on many machines, chunk by chunk.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "export/scripts.hpp"
#include "output/error_output.hpp"
#include "output/run_table.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/io/atomic_file.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/report/documents.hpp"
#include "scanmill/session/chunks.hpp"
#include "scanmill/session/page_template.hpp"
#include "scanmill/session/report_page.hpp"
#include "scanmill/workflow/ready.hpp"

namespace scanmill::runner {

namespace {

namespace fs = std::filesystem;

struct Options {
    std::string scheduler, batch, program = "scanmill";
    fs::path folder, result, records, cache;
    double minutes = 30;
    unsigned cores = 1;
    bool dry_run = false, json = false;
};

void write(const fs::path& file, const std::string& text) {
    std::error_code trouble;
    fs::create_directories(file.parent_path(), trouble);
    try {
        AtomicFile written(file);
        written.write(text);
        written.commit();
    } catch (const Error& error) {
        throw error.reworded(fmt::format("'{}' {}", file.string(), error.sentence()));
    }
    if (file.extension() == ".sh" || file.extension() == ".sbatch")
        fs::permissions(file, fs::perms::owner_exec, fs::perm_options::add, trouble);
}

/// Throws Error if the folder has chunks of another export that machines may be computing.
void require_free(const fs::path& folder) {
    std::error_code ignored;
    if (fs::exists(folder / "parts", ignored))
        throw Error("'{}' has results of an earlier export", folder.string())
            .hint("choose another folder, or remove this one when its run is merged");
}

/// The tasks that Slurm takes in an array job unless its configuration raises MaxArraySize.
constexpr std::size_t most_tasks = 1000;

/// What bench/scale/simulate.py measured, and some room: every chunk holds the names of all scans, the merge all
/// records. The page shows a limited number of cells and pictures.
constexpr double megabytes_per_scan = 0.01, megabytes_per_merged_cell = 0.015, merged_cells_per_minute = 20'000;
constexpr unsigned megabytes_of_program = 300, megabytes_of_page = 700, minutes_of_page = 60;

/// The records of earlier runs that are named, or else those of the result's folder, if it has any.
std::optional<RunRecords> earlier_records(const Options& options, const fs::path& result) {
    std::error_code absent;
    if (!options.records.empty()) return RunRecords::read(options.records / records_file);
    if (fs::exists(result / records_file, absent)) return RunRecords::read(result / records_file);
    return std::nullopt;
}

/// The expected cost, as the chunks have it.
struct Cost {
    double seconds = 0;  ///< sum over the chunks
    double longest = 0;  ///< seconds of the longest chunk on its cores
    u64 memory = 0;      ///< the most that a unit needs
};

Cost cost_of(const std::vector<Chunk>& chunks, unsigned cores) {
    Cost cost;
    for (const Chunk& chunk : chunks) {
        cost.seconds += chunk.seconds;
        cost.longest = std::max({cost.longest, chunk.seconds / cores, chunk.longest});
        cost.memory = std::max(cost.memory, chunk.memory);
    }
    return cost;
}

ExportPlan plan_of(const Options& options, const CheckedBatch& batch, const fs::path& result, std::size_t chunks,
                   const Cost& cost) {
    const auto scans = static_cast<double>(batch.batch.scans.size()), cells = static_cast<double>(batch.cells());
    const auto rounded_up = [](double value) { return static_cast<unsigned>(std::ceil(value)); };
    ExportPlan plan;
    plan.name = batch.batch.name;
    plan.folder = fs::absolute(options.folder);
    plan.directory = fs::current_path();
    plan.result = fs::absolute(result);
    if (!options.cache.empty()) plan.cache = fs::absolute(options.cache);
    plan.program = options.program;
    plan.has_page = has_page_template(report_page);
    plan.chunks = chunks;
    plan.cores = options.cores;
    plan.minutes = rounded_up(2 * cost.longest / 60) + 10;  // machines may be slower
    plan.megabytes = rounded_up(1.5 * static_cast<double>(cost.memory) / 1e6) * options.cores + megabytes_of_program +
                     rounded_up(megabytes_per_scan * scans);
    plan.merge_megabytes =
        std::max(plan.megabytes, megabytes_of_program + rounded_up(megabytes_per_merged_cell * cells)) +
        megabytes_of_page;
    plan.merge_minutes = minutes_of_page + rounded_up(cells / merged_cells_per_minute);
    return plan;
}

void write_export(const Options& options, const ExportPlan& plan, const std::vector<Chunk>& chunks) {
    require_free(plan.folder);
    for (std::size_t number = 1; number <= chunks.size(); ++number)
        write(file_of_chunk(plan.folder, number), json_of(chunks[number - 1].file).dump() + "\n");
    for (const auto& [name, text] : options.scheduler == "slurm" ? slurm_scripts(plan) : snakemake_scripts(plan))
        write(plan.folder / name, text);
    std::error_code ignored;  // the scripts make it, too
    fs::create_directories(plan.folder / "logs", ignored);
}

std::string hours_text(double seconds) { return fmt::format("{:.3g} h", seconds / 3600); }

void print_plan(const Options& options, const ExportPlan& plan, const Cost& cost, std::size_t cells,
                std::size_t estimated) {
    fmt::print("{}: {} in {}, {} of one core; {} on as many machines\n", printable_line(plan.name),
               count_text(cells, "cell", "cells"), count_text(plan.chunks, "chunk", "chunks"), hours_text(cost.seconds),
               hours_text(cost.longest));
    if (estimated > 0)
        fmt::print("the time of {} is estimated from the sizes of files; after a first run it is that of the records\n",
                   count_text(estimated, "unit", "units"));
    fmt::print("a chunk gets {}, {} MB and {} min\n", count_text(plan.cores, "core", "cores"), plan.megabytes,
               plan.minutes);
    if (!options.dry_run)
        fmt::print("to run it: {}\n", options.scheduler == "slurm"
                                          ? shell_word(options.folder / "submit.sh")
                                          : "snakemake -s " + shell_word(options.folder / "Snakefile") + " -j 4");
}

int export_batch(const Options& options) {
    const std::string file = workflow_file(options.batch, print_warning);
    FilterLibrary library = open_library();
    const CheckedBatch checked = check_batch(read_workflow_file(file), file, library);
    for (const Diagnostics& diagnostics : checked.diagnostics) print(diagnostics);
    if (checked.has_errors()) return bad_request;

    const fs::path result = options.result.empty() ? options.folder / "result" : options.result;
    const std::optional<RunRecords> records = earlier_records(options, result);
    const std::vector<UnitCost> costs = unit_costs(checked, records ? &*records : nullptr);
    const std::vector<Chunk> chunks = chunks_of(checked, costs, 60 * options.minutes * options.cores);
    const auto estimated = static_cast<std::size_t>(std::ranges::count(costs, false, &UnitCost::is_recorded));
    const Cost cost = cost_of(chunks, options.cores);
    ExportPlan plan = plan_of(options, checked, result, chunks.size(), cost);
    plan.batch = file;

    if (!options.dry_run) write_export(options, plan, chunks);
    if (options.scheduler == "slurm" && chunks.size() > most_tasks)
        print_warning(
            fmt::format("Slurm takes {} tasks in an array unless its MaxArraySize is raised, and the batch has {} "
                        "chunks; --minutes {:.0f} makes fewer",
                        most_tasks, chunks.size(),
                        std::ceil(1.01 * cost.seconds / (60.0 * options.cores * static_cast<double>(most_tasks)))));
    if (options.json)
        print_document(json_of(ExportDocument{chunks.size(), checked.cells(), cost.seconds, cost.longest, plan.minutes,
                                              plan.megabytes, estimated}));
    else
        print_plan(options, plan, cost, checked.cells(), estimated);
    return done;
}

}  // namespace

void add_export(CLI::App& app, Action& chosen) {
    auto [command, options] = add_command<Options>(
        app, chosen, "export", "Writes scripts that run a batch in chunks on many machines, with Slurm or Snakemake",
        export_batch);
    command.add_option("SCHEDULER", options.scheduler, "slurm or snakemake")
        ->required()
        ->check(CLI::IsMember({"slurm", "snakemake"}));
    command.add_option("BATCH", options.batch, "The batch file")->required();
    command.add_option("-o,--output", options.folder, "The folder of the scripts, chunks and their outputs")
        ->required();
    command.add_option("--result", options.result,
                       "The output folder of the merged run. Default: result, in that folder");
    command.add_option(
        "--records", options.records,
        "An output folder whose records have the time and memory of earlier runs. Default: the result's");
    command.add_option("--minutes", options.minutes, "The time that a chunk should take, about")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    command.add_option("--cores", options.cores, "The cores of a chunk")
        ->capture_default_str()
        ->check(CLI::Range(1, 1024));
    command.add_option("--cache", options.cache, "A cache that all machines share. Default: each machine's own");
    command
        .add_option("--program", options.program,
                    "The command that starts Scanmill on the machines. The jobs work in the current folder")
        ->capture_default_str();
    command.add_flag("--dry-run", options.dry_run, "Print the expected cost, and write nothing");
    command.add_flag("--json", options.json, "Print the result as JSON");
}

}  // namespace scanmill::runner
