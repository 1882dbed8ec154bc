// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "export/scripts.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill::runner {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view snakefile =
    R"(# Runs the batch @name@ in @chunks@ chunks, then makes one run of them, and its report.
#   snakemake -s Snakefile -j 4
#   snakemake -s Snakefile --executor slurm -j 100
workdir: @folder@
CHUNKS = [f"{number:04d}" for number in range(1, @chunks@ + 1)]
localrules: everything, merge, report

rule everything:
    input: "done/report"

rule chunk:
    input: "chunks/{chunk}.json"
    output: touch("done/{chunk}")
    log: "logs/{chunk}.txt"
    threads: @cores@
    retries: @retries@
    resources:
        attempt=lambda wildcards, attempt: attempt,
        mem_mb=lambda wildcards, attempt: @megabytes@ * 2 ** (attempt - 1),  # out of memory: twice as much
        runtime=@minutes@
    shell: @run-chunk@

rule merge:
    input: expand("done/{chunk}", chunk=CHUNKS)
    output: touch("done/merge")
    log: "logs/merge.txt"
    shell: @run-merge@

rule report:
    input: "done/merge"
    output: touch("done/report")
    log: "logs/report.txt"
    shell: @run-page@
)";

/// Exit code 1: scans failed, which the report shows. A chunk out of memory or disk is repeated; after the last attempt
/// the report shows its failures.
constexpr std::string_view after_chunk =
    "code=$?; @missing@ >> {log}; [ $code -le 1 ] || mkdir -p parts/{wildcards.chunk}; [ $code -eq 1 ] && code=0; "
    "[ $code -eq @machine-failed@ ] && [ {resources.attempt} -eq @attempts@ ] && code=0; exit $code";

/// Scans failed, or the gate tripped: the report shows it.
constexpr std::string_view after_merge = "code=$?; case $code in 1 | 4) code=0 ;; esac; exit $code";

/// In double quotes, for Python.
std::string python_text(const std::string& text) { return nlohmann::json(text).dump(); }

/// Shell text of Snakemake, in which single braces are for wildcards.
std::string with_double_braces(const std::string& text) {
    std::string all;
    for (const char c : text) {
        if (c == '{' || c == '}') all += c;
        all += c;
    }
    return all;
}

ExportPlan with_double_braces(ExportPlan plan) {
    for (std::string* text : {&plan.batch, &plan.program}) *text = with_double_braces(*text);
    for (fs::path* path : {&plan.directory, &plan.folder, &plan.result, &plan.cache})
        *path = with_double_braces(path->string());
    return plan;
}

/// A command in the jobs' folder, and what follows it, as a text for Python.
std::string shell_text(const ExportPlan& plan, const std::string& command, const std::string& after) {
    return python_text(filled("set +e; (cd @directory@ || exit 2; @command@) > {log} 2>&1; @after@",
                              {{"directory", shell_word(plan.directory)}, {"command", command}, {"after", after}}));
}

}  // namespace

Scripts snakemake_scripts(const ExportPlan& plan) {
    const ExportPlan in_shell = with_double_braces(plan);
    const std::string exit_of_chunk = filled(after_chunk, {{"missing", missing_program(in_shell, "$(uname -n)")},
                                                           {"machine-failed", std::to_string(machine_failed)},
                                                           {"attempts", std::to_string(most_attempts)}});
    const std::string exit_of_merge(after_merge);
    return {{"Snakefile",
             filled(snakefile,
                    {{"name", plan.name},
                     {"chunks", std::to_string(plan.chunks)},
                     {"folder", python_text(plan.folder.string())},
                     {"cores", std::to_string(plan.cores)},
                     {"retries", std::to_string(most_attempts - 1)},
                     {"megabytes", std::to_string(plan.megabytes)},
                     {"minutes", std::to_string(plan.minutes)},
                     {"run-chunk",
                      shell_text(in_shell, batch_command(in_shell, "{wildcards.chunk}", "{threads}"), exit_of_chunk)},
                     {"run-merge", shell_text(in_shell, merge_command(in_shell), exit_of_merge)},
                     {"run-page", shell_text(in_shell, page_command(in_shell), exit_of_merge)}})}};
}

}  // namespace scanmill::runner
