# shellcheck shell=bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Snakemake with its executor for Slurm, without and with accounting; run.sh reads this file.

if ! snakemake --help 2>/dev/null | grep -q slurm-status-command; then
    echo "skipped: the test of Snakemake with Slurm needs snakemake and snakemake-executor-plugin-slurm"
    return
fi

# with_plugin FOLDER [OPTION…]: the jobs of Snakemake itself need 200 MB.
with_plugin() {
    timeout -s KILL 180 snakemake -s "$1/Snakefile" --executor slurm -j 4 --slurm-init-seconds-before-status-checks 1 \
        --default-resources slurm_partition=main mem_mb=300 "${@:2}" >"$1.txt" 2>&1 || fail "snakemake with Slurm: $(tail -20 "$1.txt")"
}

if has_part plugin; then
    export_batch snakemake large with-squeue
    if has_cgroups; then sed -i 's/attempt: [0-9]* \*/attempt: 150 */' with-squeue/Snakefile; fi
    with_plugin with-squeue --slurm-no-account --slurm-status-command squeue
    same_result one-large with-squeue/result
    if has_cgroups; then grep -q 'Trying to restart' with-squeue.txt || fail "no chunk ran out of memory: $(cat with-squeue.txt)"; fi
    passed "snakemake with slurm, without accounting: a chunk out of memory is repeated; the results of one run"
fi

if has_part accounting; then
    if ! command -v mariadbd >/dev/null || ! command -v slurmdbd >/dev/null; then
        echo "skipped: the test with accounting needs mariadb-server and slurmdbd"
        return
    fi
    stop_slurm
    start_slurm slurmdbd
    export_batch snakemake library with-sacct
    with_plugin with-sacct
    same_result one-library with-sacct/result
    [ "$(sacct -n -X -o State | sort | uniq -c | tr -s ' ')" = ' 4 COMPLETED ' ] || fail "the accounting has other jobs: $(sacct -X)"
    passed "snakemake with slurm, with accounting: the results of one run"
fi
