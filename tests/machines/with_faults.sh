# shellcheck shell=bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Jobs of Slurm on machines that lack something: memory, disk, the program, a cache that can be written; run.sh reads this file.

if has_cgroups; then
    export_batch slurm library little-memory
    sed -i 's/--mem=[0-9]*M/--mem=15M/' little-memory/run.sbatch
    little-memory/submit.sh >/dev/null
    wait_for_jobs
    [ "$(squeue -h -t OUT_OF_MEMORY -r -n library -o %m | sort -u)" = 15M ] || fail "no chunk ran out of memory: $(squeue -t all -r)"
    has_status little-memory 'done' 1,2,3,4
    same_result one-library little-memory/result
    passed "slurm, out of memory: the chunks are submitted again with twice the memory"
else
    echo "skipped: the test of a job out of memory needs control groups of version 1"
fi

export_batch slurm library full-disk
mkdir -p full-disk/parts/0002
mount -t tmpfs -o size=1m none full-disk/parts/0002
full-disk/submit.sh >/dev/null
wait_for_jobs
grep -q 'No space left on device' full-disk/logs/0002.txt || fail "a full disk: $(cat full-disk/logs/0002.txt)"
grep -q 'out of memory or disk in chunks 2; make room' full-disk/logs/merge.txt || fail "a full disk: $(cat full-disk/logs/merge.txt)"
has_status full-disk 'done' 1,3,4
has_status full-disk failed 2
mount -o remount,size=100m full-disk/parts/0002
full-disk/submit.sh 2 600 >/dev/null
wait_for_jobs
has_status full-disk 'done' 1,2,3,4
same_result one-library full-disk/result
passed "slurm, a full disk: the chunk fails three times; with room, the result is that of one run"

export_batch slurm library no-program --program no-scanmill
no-program/submit.sh 1 >/dev/null
wait_for_jobs
grep -q '^error: node. cannot run no-scanmill; install' no-program/logs/0001.txt || fail "a missing program: $(cat no-program/logs/0001.txt)"
has_status no-program failed 1
passed "slurm, without the program: one sentence names the node and the way out"

mkdir cache
mount -t tmpfs -o size=1m,ro none cache
export_batch slurm library read-only --cache cache
read-only/submit.sh >/dev/null
wait_for_jobs
[ "$(grep -c 'Read-only file system' read-only/logs/0001.txt)" = 1 ] || fail "a read-only cache: $(cat read-only/logs/0001.txt)"
same_result one-library read-only/result
passed "slurm, a read-only cache: one warning, and the results of one run"
