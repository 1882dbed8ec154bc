// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cctype>

#include "commands/commands.hpp"
#include "export/scripts.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill::runner {

namespace {

constexpr std::string_view head = R"(#!/bin/sh
#SBATCH --job-name=@name@
#SBATCH --cpus-per-task=@cores@
#SBATCH --mem=@megabytes@M
#SBATCH --time=@time@
)";

/// 137: the system killed the program, as it does when the memory of the job is used up.
constexpr std::string_view run = R"(#SBATCH --array=1-@chunks@
#SBATCH --output=logs/%4a.txt
# Runs one chunk. Exit code 1: scans failed, which the report shows. @machine-failed@ or 137: memory or disk was full.
cd @directory@ || exit 2
folder=@folder@
chunk=$(printf %04d "$SLURM_ARRAY_TASK_ID")
rm -f "$folder/again/$chunk"
@batch@
code=$?
@missing@ >&2
case $code in @machine-failed@ | 137) mkdir -p "$folder/again" && : > "$folder/again/$chunk" ;; esac  # for merge.sbatch
[ $code -le 1 ] || mkdir -p "$folder/parts/$chunk"  # makes it a failed chunk for --status
[ $code -eq 1 ] && exit 0
exit $code
)";

constexpr std::string_view merge = R"(#SBATCH --output=logs/merge.txt
# merge.sbatch [MEGABYTES]: makes one run of all chunks, and its report. Before that, submits the chunks again that ran
# out of memory or disk, with twice the memory, until they had @most-megabytes@ MB.
cd @directory@ || exit 2
folder=@folder@
megabytes=${1:-@chunk-megabytes@}
again=$(ls "$folder/again" 2>/dev/null | sed 's/^0*//' | paste -sd, -)
if [ -n "$again" ] && [ "$megabytes" -lt @most-megabytes@ ]; then
    "$folder/submit.sh" "$again" $((2 * megabytes)) && exit 0
fi
[ -z "$again" ] || echo "error: out of memory or disk in chunks $again; make room, then call: "@submit@" $again MEGABYTES"
@merge@
code=$?
case $code in 0 | 1 | 4) ;; *) exit $code ;; esac  # nothing was merged
@page@ -j @cores@
page=$?
case $page in 0 | 1 | 4) exit $code ;; *) exit $page ;; esac  # 1, 4: the verdict again
)";

/// The chunks are held until the merge is submitted, so that they do not run if it is refused.
constexpr std::string_view submit = R"(#!/bin/sh
# submit.sh [CHUNKS [MEGABYTES]]: submits all chunks, or those with these numbers, as 3,17; then the merge, which waits
# for them.
cd @folder@ && mkdir -p logs || exit 1
run=$(sbatch --parsable --hold ${1:+--array="$1"} ${2:+--mem="$2M"} run.sbatch) || exit 1
run=${run%%;*}
merge=$(sbatch --parsable --dependency=afterany:"$run" merge.sbatch "${2:-@megabytes@}") || {
    scancel "$run"
    echo "error: the merge was refused, so the chunks were cancelled" >&2
    exit 1
}
scontrol release "$run" || {
    scancel "$run" "${merge%%;*}"
    echo "error: the chunks could not be released, so they and the merge were cancelled" >&2
    exit 1
}
echo "chunks are job $run, the merge is job ${merge%%;*}"
)";

/// Without blanks, which the name of a job must not have.
std::string job_name(std::string name) {
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '_';
    return name;
}

std::string head_of_job(const ExportPlan& plan, unsigned megabytes, unsigned minutes) {
    return filled(head, {{"name", job_name(plan.name)},
                         {"cores", std::to_string(plan.cores)},
                         {"megabytes", std::to_string(megabytes)},
                         {"time", fmt::format("{:02}:{:02}:00", minutes / 60, minutes % 60)}});
}

}  // namespace

Scripts slurm_scripts(const ExportPlan& plan) {
    const std::string directory = shell_word(plan.directory), folder = shell_word(plan.folder);
    Scripts scripts;
    scripts["run.sbatch"] = head_of_job(plan, plan.megabytes, plan.minutes) +
                            filled(run, {{"chunks", std::to_string(plan.chunks)},
                                         {"machine-failed", std::to_string(machine_failed)},
                                         {"directory", directory},
                                         {"folder", folder},
                                         {"batch", batch_command(plan, "\"$chunk\"", "\"$SLURM_CPUS_PER_TASK\"")},
                                         {"missing", missing_program(plan, "${SLURMD_NODENAME:-$(uname -n)}")}});
    scripts["merge.sbatch"] = head_of_job(plan, plan.merge_megabytes, plan.merge_minutes) +
                              filled(merge, {{"chunk-megabytes", std::to_string(plan.megabytes)},
                                             {"most-megabytes", std::to_string(plan.megabytes << (most_attempts - 1))},
                                             {"directory", directory},
                                             {"folder", folder},
                                             {"submit", shell_word(shell_word(plan.folder / "submit.sh"))},
                                             {"merge", merge_command(plan)},
                                             {"page", page_command(plan)},
                                             {"cores", std::to_string(plan.cores)}});
    scripts["submit.sh"] = filled(submit, {{"folder", folder}, {"megabytes", std::to_string(plan.megabytes)}});
    return scripts;
}

}  // namespace scanmill::runner
