# shellcheck shell=bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Chunks as an array job of Slurm: parts of it, killed jobs, nodes that are drained or lost; run.sh reads this file.

# submit FOLDER [CHUNKS]: sets `job` to the number of the array job.
submit() { job=$("$1/submit.sh" "${@:2}" | sed -n 's/^chunks are job \([0-9]*\),.*/\1/p'); }

# wait_for_chunk FOLDER STATE CHUNKS
wait_for_chunk() {
    wait_until 60 is_status "$@" || fail "$1: chunks $3 did not become $2: $(cat status.txt) $(squeue)"
}

node_of() { squeue -h -j "$1" -o %N; }

export_batch slurm library with-slurm
submit with-slurm 1,3
wait_for_jobs
has_status with-slurm 'done' 1,3
grep -q 'shards are missing: 2/4 and 4/4' with-slurm/logs/merge.txt || fail "the merge did not refuse: $(cat with-slurm/logs/merge.txt)"
submit with-slurm 2,4
wait_for_jobs
has_status with-slurm 'done' 1,2,3,4
same_result one-library with-slurm/result
passed "slurm: 8 cells in chunks on two nodes give the results of one run"

export_batch slurm large killed
submit killed
wait_for_chunk killed running 2
scancel "${job}_2"
wait_for_jobs
has_status killed 'done' 1
has_status killed failed 2
grep -q "parts/0002'" killed/logs/merge.txt || fail "the merge did not refuse: $(cat killed/logs/merge.txt)"
submit killed 2
wait_for_jobs
same_result one-large killed/result
passed "slurm, a killed job: only its chunk is submitted again"

export_batch slurm large drained
submit drained
wait_for_chunk drained running 2
node=$(node_of "${job}_2")
scontrol update NodeName="$node" State=DRAIN Reason=test
submit drained 1
wait_for_jobs
same_result one-large drained/result
sinfo -h -n "$node" -o %T | grep -q drained || fail "the node is not drained: $(sinfo)"
scontrol update NodeName="$node" State=RESUME
passed "slurm, a drained node: its chunk ends, the others run elsewhere"

# Ends everything on the node, as a power failure does.
lose_node() {
    local all pid parent
    mapfile -t all < <(find /sys/fs/cgroup/*/"slurm_$1" -name cgroup.procs -exec cat {} + | sort -u)
    for pid in "${all[@]}"; do
        parent=$(awk '$1 == "PPid:" {print $2}' "/proc/$pid/status")
        if [ "$(cat "/proc/$parent/comm")" = slurmstepd ]; then all+=("$parent"); fi
    done
    kill -KILL "$(cat "slurm/slurmd-$1.pid")" "${all[@]}" || true
}

if has_cgroups; then
    export_batch slurm large lost
    submit lost
    wait_for_chunk lost running 2
    node=$(node_of "${job}_2")
    lose_node "$node"
    wait_for_chunk lost failed 2
    wait_for_jobs
    has_status lost 'done' 1,2
    same_result one-large lost/result
    slurmd -N "$node"
    wait_until 30 are_nodes_idle || fail "the node does not come back: $(sinfo)"
    passed "slurm, a lost node: its chunk is queued again by itself"
else
    echo "skipped: the test of a lost node needs control groups of version 1"
fi
