#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# cluster.sh obstacle | start FOLDER | stop FOLDER: a Slurm of four nodes with one core each on this machine, in FOLDER. `obstacle` prints
# why it cannot be started here.
set -euo pipefail
folder=${2:-/nowhere}
nodes=4
cores_per_node=1
fail() {
    echo "error: $*" >&2
    exit 1
}
# shellcheck source=tests/machines/slurm.sh
. "$(dirname "$0")/../../tests/machines/slurm.sh"
case "$1" in
    obstacle) slurm_obstacle ;;
    start)
        mkdir -p "$folder/slurm"
        start_slurm
        echo "${has_own_munge:-}" >"$folder/own-munge"
        ;;
    stop)
        has_own_munge=$(cat "$folder/own-munge" 2>/dev/null || true)
        stop_slurm
        ;;
esac
