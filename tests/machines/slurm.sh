# shellcheck shell=bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Nodes of Slurm on this machine, in the folder "$folder/slurm", which the script that reads this file sets. Needs root.
: "${folder:?}" "${nodes:=2}" "${cores_per_node:=2}"

# Prints why Slurm cannot be started here; prints nothing if it can.
slurm_obstacle() {
    local program
    for program in slurmctld slurmd munged; do
        command -v "$program" >/dev/null || { echo "needs slurmctld, slurmd and munged, which Debian has in slurm-wlm and munge"; return; }
    done
    [ "$(id -u)" = 0 ] || echo "needs root, which starts the nodes"
    [ ! -e /etc/slurm/slurm.conf ] || echo "cannot use this machine, which has a Slurm of its own"
}

# wait_until SECONDS COMMAND…: repeats the command until it succeeds.
wait_until() {
    local end=$((SECONDS + $1))
    while ! "${@:2}" >/dev/null 2>&1; do
        [ $SECONDS -lt $end ] || return 1
        sleep 0.2
    done
}

are_nodes_idle() { [ "$(sinfo -h -p main -t idle -o %D)" = "$nodes" ]; }

has_cgroups() { [ -e /sys/fs/cgroup/memory/memory.limit_in_bytes ]; }

# write_slurm_conf ACCOUNTING: `none`, or `slurmdbd`.
write_slurm_conf() {
    local number host task=task/none track=proctrack/linuxproc
    host=$(hostname -s)
    if has_cgroups; then task=task/cgroup track=proctrack/cgroup; fi
    cat >"$folder/slurm/slurm.conf" <<END
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
ProctrackType=$track
TaskPlugin=$task
JobAcctGatherType=jobacct_gather/linux
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
AccountingStorageType=accounting_storage/$1
ReturnToService=2
SlurmdTimeout=10
KillWait=5
SchedulerParameters=sched_interval=1,bf_interval=1,batch_sched_delay=0
SlurmdParameters=config_overrides
DefMemPerCPU=200
NodeName=node[1-$nodes] NodeHostname=$host NodeAddr=127.0.0.1 Port=[26821-$((26820 + nodes))] CPUs=$cores_per_node CoresPerSocket=$cores_per_node RealMemory=4000
PartitionName=main Nodes=node[1-$nodes] Default=YES State=UP
END
    # The partition first2 has the first two nodes.
    for number in $(seq "$nodes"); do echo "PartitionName=first$number Nodes=node[1-$number] State=UP"; done >>"$folder/slurm/slurm.conf"
    [ "$1" != slurmdbd ] || printf '%s\n' AccountingStorageHost=localhost AccountingStoragePort=26819 >>"$folder/slurm/slurm.conf"
    printf '%s\n' CgroupPlugin=cgroup/v1 CgroupMountpoint=/sys/fs/cgroup CgroupAutomount=no ConstrainRAMSpace=yes ConstrainSwapSpace=no \
        ConstrainCores=no ConstrainDevices=no MinRAMSpace=10 >"$folder/slurm/cgroup.conf"
}

start_munge() {
    if pgrep -x munged >/dev/null; then return; fi
    install -d -o munge -g munge -m 755 /run/munge
    install -d -o munge -g munge -m 700 /var/log/munge
    runuser -u munge -- munged
    has_own_munge=yes
}

# start_slurm [slurmdbd]
start_slurm() {
    local number
    rm -rf "$folder/slurm/state" "$folder/slurm"/node?
    for number in $(seq "$nodes"); do mkdir -p "$folder/slurm/node$number"; done
    install -d -o slurm "$folder/slurm/state" "$folder/slurm/log"
    write_slurm_conf "${1:-none}"
    # The Snakemake plugin removes SLURM_CONF from the environment of jobs, so the file must be where Slurm looks for it.
    ln -sf "$folder/slurm/slurm.conf" "$folder/slurm/cgroup.conf" /etc/slurm/
    start_munge
    [ -z "${1:-}" ] || start_slurmdbd
    slurmctld
    for number in $(seq "$nodes"); do slurmd -N "node$number"; done
    wait_until 30 are_nodes_idle || fail "the nodes do not start: $(sinfo)"
}

has_ended() { ! kill -0 "$1"; }

# kill_and_wait PIDFILE…: ends the processes and waits until they have.
kill_and_wait() {
    local file pid
    for file in "$@"; do
        [ -e "$file" ] || continue
        pid=$(cat "$file")
        kill "$pid" 2>/dev/null || continue
        wait_until 10 has_ended "$pid" || kill -KILL "$pid"
    done
}

stop_slurm() {
    [ -d "$folder/slurm" ] || return 0
    kill_and_wait "$folder"/slurm/slurmd-*.pid "$folder/slurm/slurmctld.pid" "$folder/slurm/slurmdbd.pid" "$folder/slurm/database/mariadb.pid"
    [ -z "${has_own_munge:-}" ] || kill_and_wait /run/munge/munged.pid
    # The links may be those of another test on this machine.
    [ "$(readlink /etc/slurm/slurm.conf)" != "$folder/slurm/slurm.conf" ] || rm -f /etc/slurm/slurm.conf /etc/slurm/cgroup.conf /etc/slurm/slurmdbd.conf
}

# Starts MariaDB and slurmdbd, which record the jobs for `sacct`.
start_slurmdbd() {
    local data=$folder/slurm/database socket=/run/mysqld/mysqld.sock
    mariadb-install-db --no-defaults --datadir="$data" --user=mysql --auth-root-authentication-method=normal --skip-test-db >/dev/null
    install -d -o mysql /run/mysqld
    setsid mariadbd --no-defaults --datadir="$data" --user=mysql --socket=$socket --skip-networking --innodb-buffer-pool-size=64M \
        --innodb-lock-wait-timeout=900 --pid-file="$data/mariadb.pid" >"$folder/slurm/log/mariadb.log" 2>&1 &
    wait_until 30 mariadb-admin --no-defaults --socket=$socket ping || fail "MariaDB does not start"
    mariadb --no-defaults --socket=$socket -e "create database slurm_acct_db; create user slurm@localhost identified by 'test';
        grant all on slurm_acct_db.* to slurm@localhost"
    printf '%s\n' AuthType=auth/munge DbdHost=localhost DbdPort=26819 SlurmUser=slurm StorageType=accounting_storage/mysql \
        StorageHost=localhost StorageUser=slurm StoragePass=test StorageLoc=slurm_acct_db "LogFile=$folder/slurm/log/slurmdbd.log" \
        "PidFile=$folder/slurm/slurmdbd.pid" >"$folder/slurm/slurmdbd.conf"
    chown slurm "$folder/slurm/slurmdbd.conf" "$folder/slurm"
    chmod 600 "$folder/slurm/slurmdbd.conf"
    ln -sf "$folder/slurm/slurmdbd.conf" /etc/slurm/
    slurmdbd
    wait_until 30 sacctmgr -n list cluster || fail "slurmdbd does not start"
    sacctmgr -i add cluster test >/dev/null
    sacctmgr -i add account lab Description=lab Organization=lab >/dev/null
    sacctmgr -i add user root Account=lab >/dev/null
}

has_no_jobs() { [ -z "$(squeue -h)" ]; }

wait_for_jobs() { wait_until 120 has_no_jobs || fail "jobs still run after two minutes: $(squeue)"; }
