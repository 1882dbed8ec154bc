#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# run.sh PROGRAM: runs an exported batch with Snakemake and with Slurm, and compares its outputs with those of one run. Each part is
# skipped, with a sentence, where its programs are missing. For Slurm, two nodes are started on this machine, as root.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
program=$(realpath "$1")
folder=$(mktemp -d)
chmod 755 "$folder"
mkdir "$folder/bin"
ln -s "$program" "$folder/bin/scanmill"
export PATH="$folder/bin:$PATH" HOME="$folder"
cd "$folder"

stop() {
    for pid in "$folder"/slurm/*.pid; do [ ! -e "$pid" ] || kill "$(cat "$pid")" 2>/dev/null || true; done
    [ -z "${munge:-}" ] || kill "$munge" 2>/dev/null || true
    sleep 1
    rm -rf "$folder"
}
trap stop EXIT

fail() {
    echo "FAILED: $*"
    exit 1
}

# The files of the page on many machines, and four scans.
awk '/^<!-- file: /{name=$3} /^```/{if (open) {open=0; name=""} else if (name) {open=1; next}} open{print > name}' "$root/docs/how-to/many-machines.md"
mkdir scans
for size in 60 80 100 120; do
    scanmill run scan.yaml --set size="$size u" -o . -q >/dev/null
    mv scan.ply "scans/$size.ply"
done
scanmill batch library.yaml -o one -q >/dev/null

# same_outputs FOLDER: the meshes are those of the one run, byte for byte.
same_outputs() {
    for file in one/*.ply one/*.ply.json; do cmp "$file" "$1/$(basename "$file")" || fail "$1 differs"; done
    [ "$(scanmill report "$1" | sed -n 2p)" = "8 cells: 8 new" ] || fail "the report of $1 differs"
}

if command -v snakemake >/dev/null; then
    scanmill export snakemake library.yaml -o with-snakemake --records one --minutes 0.001 >/dev/null
    snakemake -s with-snakemake/Snakefile -j 2 >snakemake.txt 2>&1 || fail "snakemake: $(tail -5 snakemake.txt)"
    same_outputs with-snakemake/result
    [ -s with-snakemake/result/report.html ] || echo "no report page: this program was built without it"
    echo "snakemake: 8 cells in chunks give the outputs of one run"
else
    echo "skipped: the test with Snakemake needs snakemake"
fi

if ! command -v slurmctld >/dev/null || ! command -v slurmd >/dev/null || ! command -v munged >/dev/null || [ "$(id -u)" != 0 ]; then
    echo "skipped: the test with Slurm needs slurmctld, slurmd and munged, as Debian's slurm-wlm and munge have them, and root"
    exit 0
fi
if [ -e /etc/slurm/slurm.conf ]; then
    echo "skipped: this machine has a Slurm of its own"
    exit 0
fi
mkdir slurm slurm/node1 slurm/node2
install -d -o slurm slurm/state slurm/log
host=$(hostname -s)
export SLURM_CONF=$folder/slurm/slurm.conf
cat >"$SLURM_CONF" <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=26817
SlurmUser=slurm
SlurmdUser=root
AuthType=auth/munge
AuthInfo=cred_expire=5
StateSaveLocation=$folder/slurm/state
SlurmdSpoolDir=$folder/slurm/%n
SlurmctldPidFile=$folder/slurm/slurmctld.pid
SlurmdPidFile=$folder/slurm/slurmd-%n.pid
SlurmctldLogFile=$folder/slurm/log/slurmctld.log
SlurmdLogFile=$folder/slurm/log/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
AccountingStorageType=accounting_storage/none
ReturnToService=2
SchedulerParameters=sched_interval=2,bf_interval=2,batch_sched_delay=0
SlurmdParameters=config_overrides
NodeName=node[1-2] NodeHostname=$host NodeAddr=127.0.0.1 Port=[26821-26822] CPUs=2 CoresPerSocket=2 RealMemory=4000
PartitionName=main Nodes=node[1-2] Default=YES State=UP
END
if ! pgrep -x munged >/dev/null; then
    install -d -o munge -g munge -m 755 /run/munge
    install -d -o munge -g munge -m 700 /var/log/munge
    runuser -u munge -- munged
    munge=$(pgrep -x munged)
fi
slurmctld
slurmd -N node1
slurmd -N node2
for _ in $(seq 30); do [ "$(sinfo -h -t idle -o %D 2>/dev/null)" = 2 ] && break || sleep 1; done

wait_for_jobs() {
    for _ in $(seq 120); do
        [ -n "$(squeue -h)" ] || return 0
        sleep 1
    done
    fail "jobs still run after two minutes: $(squeue)"
}

scanmill export slurm library.yaml -o with-slurm --records one --minutes 0.001 >/dev/null
with-slurm/submit.sh 1,3 >/dev/null
wait_for_jobs
scanmill batch --status with-slurm >status.txt
grep -q '^done  *2  1,3$' status.txt || fail "after chunks 1 and 3: $(cat status.txt)"
grep -q 'shards are missing: 2/4 and 4/4' with-slurm/logs/merge.txt || fail "the merge did not refuse: $(cat with-slurm/logs/merge.txt)"
with-slurm/submit.sh 2,4 >/dev/null
wait_for_jobs
scanmill batch --status with-slurm >status.txt
grep -q '^done  *4  1,2,3,4$' status.txt || fail "after all chunks: $(cat status.txt)"
same_outputs with-slurm/result
echo "slurm: 8 cells in chunks on two nodes give the outputs of one run"
