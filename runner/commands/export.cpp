// SPDX-License-Identifier: GPL-3.0-or-later
// The command `export`: scripts that run a batch on many machines, chunk by chunk.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "output/error_output.hpp"
#include "output/run_table.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/io/atomic_file.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/report/documents.hpp"
#include "scanmill/session/chunks.hpp"
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

/// What the scripts need to know.
struct Plan {
    std::string name;  ///< of the batch
    std::string batch;  ///< file, as the user named it
    fs::path directory;  ///< absolute; the jobs work in it, so that they name scans as a run of the user does
    fs::path folder, result, cache;  ///< absolute; `cache`: empty for the default
    std::string program;
    std::size_t chunks = 0;
    unsigned cores = 1, megabytes = 0, minutes = 0;  ///< of a chunk
    unsigned merge_megabytes = 0, merge_minutes = 0;
};

/// In single quotes, for a shell.
std::string quoted(const std::string& text) {
    std::string all = "'";
    for (const char c : text) c == '\'' ? all += "'\\''" : all += c;
    return all + "'";
}

std::string change_directory(const Plan& plan) {
    return fmt::format("cd {} || exit 3", quoted(plan.directory.string()));
}

std::string batch_command(const Plan& plan, const std::string& chunk, const std::string& jobs) {
    const std::string folder = quoted(plan.folder.string());
    return fmt::format("{} batch {} --cells {}/chunks/{}.json -o {}/parts/{} -j {} -q{}", plan.program,
                       quoted(plan.batch), folder, chunk, folder, chunk, jobs,
                       plan.cache.empty() ? "" : " --cache " + quoted(plan.cache.string()));
}

std::string merge_command(const Plan& plan) {
    return fmt::format("{} runs merge {}/parts/* -o {}", plan.program, quoted(plan.folder.string()),
                       quoted(plan.result.string()));
}

std::string page_command(const Plan& plan) {
    return fmt::format("{} report {} --html {}", plan.program, quoted(plan.result.string()),
                       quoted((plan.result / "report.html").string()));
}

std::string time_text(unsigned minutes) { return fmt::format("{:02}:{:02}:00", minutes / 60, minutes % 60); }

/// The name of a job, which must not have blanks.
std::string job_name(const Plan& plan) {
    std::string name = plan.name;
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '_';
    return name;
}

/// Files by name.
using Files = std::vector<std::pair<std::string, std::string>>;

/// How often a chunk runs if the machine runs out of memory or disk; every time with twice the memory.
constexpr unsigned most_attempts = 3;

/// Shell text that reports a missing program; `node` prints the name of the machine.
std::string missing_program(const Plan& plan, const std::string& node) {
    const std::string sentence =
        fmt::format("cannot run {}; install Scanmill there, or export the batch with --program PATH", plan.program);
    return fmt::format("[ $code -eq 126 ] || [ $code -eq 127 ] && echo \"error: {} \"{}", node, quoted(sentence));
}

std::string head_of_job(const Plan& plan, unsigned megabytes, unsigned minutes) {
    return fmt::format(
        "#!/bin/sh\n"
        "#SBATCH --job-name={}\n"
        "#SBATCH --cpus-per-task={}\n"
        "#SBATCH --mem={}M\n"
        "#SBATCH --time={}\n",
        job_name(plan), plan.cores, megabytes, time_text(minutes));
}

Files slurm_files(const Plan& plan) {
    const std::string run =
        head_of_job(plan, plan.megabytes, plan.minutes) +
        fmt::format(
            "#SBATCH --array=1-{}\n"
            "#SBATCH --output=logs/%4a.txt\n"
            "# Runs one chunk. Exit code 1: scans failed, which the report shows. {}: memory or disk was full.\n"
            "{}\n"
            "folder={}\n"
            "chunk=$(printf %04d \"$SLURM_ARRAY_TASK_ID\")\n"
            "rm -f \"$folder/again/$chunk\"\n"
            "{}\n"
            "code=$?\n"
            "{} >&2\n"
            "[ $code -eq {} ] && mkdir -p \"$folder/again\" && : > \"$folder/again/$chunk\"  # for merge.sbatch\n"
            "[ $code -le 1 ] || mkdir -p \"$folder/parts/$chunk\"  # makes it a failed chunk for --status\n"
            "[ $code -eq 1 ] && exit 0\n"
            "exit $code\n",
            plan.chunks, int(machine_failed), change_directory(plan), quoted(plan.folder.string()),
            batch_command(plan, "\"$chunk\"", "\"$SLURM_CPUS_PER_TASK\""),
            missing_program(plan, "${SLURMD_NODENAME:-$(uname -n)}"), int(machine_failed));
    const std::string merge =
        head_of_job(plan, plan.merge_megabytes, plan.merge_minutes) +
        fmt::format(
            "#SBATCH --output=logs/merge.txt\n"
            "# merge.sbatch [MEGABYTES]: makes one run of all chunks, and its report. Before that, submits the chunks\n"
            "# again that ran out of memory or disk, with twice the memory, until they had {} MB.\n"
            "{}\n"
            "folder={}\n"
            "megabytes=${{1:-{}}}\n"
            "again=$(ls \"$folder/again\" 2>/dev/null | sed 's/^0*//' | paste -sd, -)\n"
            "if [ -n \"$again\" ] && [ \"$megabytes\" -lt {} ]; then\n"
            "    \"$folder/submit.sh\" \"$again\" $((2 * megabytes)) && exit 0\n"
            "fi\n"
            "[ -z \"$again\" ] || echo \"error: out of memory or disk in chunks $again; make room, then "
            "call: submit.sh $again MEGABYTES\"\n"
            "{}\n"
            "code=$?\n"
            "case $code in 0 | 1 | 4) {} || : ;; esac  # nothing was merged otherwise\n"
            "exit $code\n",
            plan.megabytes << (most_attempts - 1), change_directory(plan), quoted(plan.folder.string()), plan.megabytes,
            plan.megabytes << (most_attempts - 1), merge_command(plan), page_command(plan));
    const std::string submit = fmt::format(
        "#!/bin/sh\n"
        "# submit.sh [CHUNKS [MEGABYTES]]: submits all chunks, or those with these numbers, as 3,17; then the merge, "
        "which waits\n"
        "# for them.\n"
        "set -e\n"
        "cd {}\n"
        "mkdir -p logs\n"
        "run=$(sbatch --parsable ${{1:+--array=\"$1\"}} ${{2:+--mem=\"$2M\"}} run.sbatch)\n"
        "merge=$(sbatch --parsable --dependency=afterany:\"${{run%%;*}}\" merge.sbatch \"${{2:-{}}}\")\n"
        "echo \"chunks are job ${{run%%;*}}, the merge is job ${{merge%%;*}}\"\n",
        quoted(plan.folder.string()), plan.megabytes);
    return {{"run.sbatch", run}, {"merge.sbatch", merge}, {"submit.sh", submit}};
}

/// In double quotes, for Python.
std::string python_text(const std::string& text) { return nlohmann::json(text).dump(); }

/// Shell text of Snakemake, in which single braces are for wildcards.
std::string snakemake_shell(const std::string& text) {
    std::string all;
    for (const char c : text) {
        if (c == '{' || c == '}') all += c;
        all += c;
    }
    return all;
}

/// The plan for commands in shell text of Snakemake.
Plan snakemake_shell(Plan plan) {
    for (std::string* text : {&plan.batch, &plan.program}) *text = snakemake_shell(*text);
    for (fs::path* path : {&plan.directory, &plan.folder, &plan.result, &plan.cache})
        *path = snakemake_shell(path->string());
    return plan;
}

Files snakemake_files(const Plan& plan) {
    const Plan in_shell = snakemake_shell(plan);
    const auto command = [&](const std::string& text, const std::string& exit) {
        return python_text(fmt::format("set +e; ({}; {}) > {{log}} 2>&1; {}", change_directory(in_shell), text, exit));
    };
    // Exit code 1: scans failed; 4: the gate tripped. The report shows both. A chunk that ran out of memory or disk is
    // repeated; after the last attempt the report shows its failures.
    const std::string code_of_chunk = fmt::format(
        "code=$?; {} >> {{log}}; [ $code -le 1 ] || mkdir -p parts/{{wildcards.chunk}}; [ $code -eq 1 ] && code=0; "
        "[ $code -eq {} ] && [ {{resources.attempt}} -eq {} ] && code=0; exit $code",
        missing_program(in_shell, "$(uname -n)"), int(machine_failed), most_attempts);
    const std::string code_of_merge = "code=$?; [ $code -eq 1 ] || [ $code -eq 4 ] && code=0; exit $code";
    const std::string text = fmt::format(
        "# Runs the batch {0} in {1} chunks, then makes one run of them, and its report.\n"
        "#   snakemake -s Snakefile -j 4\n"
        "#   snakemake -s Snakefile --executor slurm -j 100\n"
        "workdir: {2}\n"
        "CHUNKS = [f\"{{number:04d}}\" for number in range(1, {3} + 1)]\n"
        "localrules: everything, merge, report\n"
        "\n"
        "rule everything:\n"
        "    input: \"done/report\"\n"
        "\n"
        "rule chunk:\n"
        "    input: \"chunks/{{chunk}}.json\"\n"
        "    output: touch(\"done/{{chunk}}\")\n"
        "    log: \"logs/{{chunk}}.txt\"\n"
        "    threads: {4}\n"
        "    retries: {10}\n"
        "    resources:\n"
        "        attempt=lambda wildcards, attempt: attempt,\n"
        "        mem_mb=lambda wildcards, attempt: {5} * 2 ** (attempt - 1),  # out of memory: twice as much\n"
        "        runtime={6}\n"
        "    shell: {7}\n"
        "\n"
        "rule merge:\n"
        "    input: expand(\"done/{{chunk}}\", chunk=CHUNKS)\n"
        "    output: touch(\"done/merge\")\n"
        "    log: \"logs/merge.txt\"\n"
        "    shell: {8}\n"
        "\n"
        "rule report:\n"
        "    input: \"done/merge\"\n"
        "    output: touch(\"done/report\")\n"
        "    log: \"logs/report.txt\"\n"
        "    shell: {9}\n",
        plan.name, plan.chunks, python_text(plan.folder.string()), plan.chunks, plan.cores, plan.megabytes,
        plan.minutes, command(batch_command(in_shell, "{wildcards.chunk}", "{threads}"), code_of_chunk),
        command(merge_command(in_shell), code_of_merge), command(page_command(in_shell), "exit 0"), most_attempts - 1);
    return {{"Snakefile", text}};
}

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
/// records.
constexpr double megabytes_per_scan = 0.01, megabytes_per_merged_cell = 0.015, merged_cells_per_minute = 30'000;

std::string hours_text(double seconds) { return fmt::format("{:.3g} h", seconds / 3600); }

int export_batch(const Options& options) {
    const std::string file = workflow_file(options.batch, print_warning);
    FilterLibrary library = open_library();
    const CheckedBatch checked = check_batch(read_workflow_file(file), file, library);
    for (const Diagnostics& diagnostics : checked.diagnostics) print(diagnostics);
    if (checked.has_errors()) return bad_request;
    std::optional<RunRecords> records;
    const fs::path result = options.result.empty() ? options.folder / "result" : options.result;
    std::error_code absent;
    if (!options.records.empty())
        records.emplace(RunRecords::read(options.records / records_file));
    else if (fs::exists(result / records_file, absent))
        records.emplace(RunRecords::read(result / records_file));
    const std::vector<UnitCost> costs = unit_costs(checked, records ? &*records : nullptr);
    const double seconds = 60 * options.minutes * options.cores;
    const std::vector<Chunk> chunks = chunks_of(checked, costs, seconds);

    Plan plan;
    plan.name = checked.batch.name;
    plan.batch = file;
    plan.folder = fs::absolute(options.folder);
    plan.directory = fs::path(file).is_absolute() ? plan.folder : fs::current_path();
    plan.result = fs::absolute(result);
    if (!options.cache.empty()) plan.cache = fs::absolute(options.cache);
    plan.program = options.program;
    plan.chunks = chunks.size();
    plan.cores = options.cores;
    double total = 0, longest = 0;
    u64 memory = 0;
    for (const Chunk& chunk : chunks) {
        total += chunk.seconds;
        longest = std::max({longest, chunk.seconds / options.cores, chunk.longest});
        memory = std::max(memory, chunk.memory);
    }
    // Room for slower machines, and for the program itself.
    plan.minutes = static_cast<unsigned>(std::ceil(2 * longest / 60)) + 10;
    const auto program_megabytes =
        300 + static_cast<unsigned>(megabytes_per_scan * static_cast<double>(checked.batch.scans.size()));
    plan.megabytes =
        static_cast<unsigned>(std::ceil(1.5 * static_cast<double>(memory) / 1e6)) * options.cores + program_megabytes;
    const auto cells = static_cast<double>(checked.cells());
    plan.merge_megabytes = std::max(plan.megabytes, 300 + static_cast<unsigned>(megabytes_per_merged_cell * cells));
    plan.merge_minutes = 30 + static_cast<unsigned>(cells / merged_cells_per_minute);
    const auto estimated = static_cast<std::size_t>(std::ranges::count(costs, false, &UnitCost::is_recorded));

    if (!options.dry_run) {
        require_free(plan.folder);
        for (std::size_t number = 1; number <= chunks.size(); ++number)
            write(file_of_chunk(plan.folder, number), json_of(chunks[number - 1].file).dump() + "\n");
        for (const auto& [name, text] : options.scheduler == "slurm" ? slurm_files(plan) : snakemake_files(plan))
            write(plan.folder / name, text);
        fs::create_directories(plan.folder / "logs", absent);
    }
    if (options.scheduler == "slurm" && chunks.size() > most_tasks)
        print_warning(
            fmt::format("Slurm takes {} tasks in an array unless its MaxArraySize is raised, and the batch has {} "
                        "chunks; --minutes {:.0f} makes fewer",
                        most_tasks, chunks.size(),
                        std::ceil(1.01 * total / (60.0 * options.cores * static_cast<double>(most_tasks)))));
    if (options.json) {
        print_document(json_of(
            ExportDocument{chunks.size(), checked.cells(), total, longest, plan.minutes, plan.megabytes, estimated}));
        return done;
    }
    fmt::print("{}: {} in {}, {} of one core; {} on as many machines\n", printable_line(plan.name),
               count_text(checked.cells(), "cell", "cells"), count_text(chunks.size(), "chunk", "chunks"),
               hours_text(total), hours_text(longest));
    if (estimated > 0)
        fmt::print("the time of {} is estimated from the sizes of files; after a first run it is that of the records\n",
                   count_text(estimated, "unit", "units"));
    fmt::print("a chunk gets {}, {} MB and {} min\n", count_text(plan.cores, "core", "cores"), plan.megabytes,
               plan.minutes);
    if (!options.dry_run)
        fmt::print("to run it: {}\n", options.scheduler == "slurm"
                                          ? shell_word(options.folder / "submit.sh")
                                          : "snakemake -s " + shell_word(options.folder / "Snakefile") + " -j 4");
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
