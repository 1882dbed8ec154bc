#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints the machine, then runs every performance bench of a build folder; each prints its own ratios. peers/run.sh runs the
# comparisons with other programs.
set -euo pipefail
build=$1
root=$(cd "$(dirname "$0")/.." && pwd)
echo "machine: $(lscpu | sed -n 's/^Model name: *//p'), $(nproc) cores, load $(cut -d' ' -f1-3 /proc/loadavg), $(date -u +%Y-%m-%d)"
for program in "$build"/bin/*_bench; do
    echo
    echo "== $(basename "$program")"
    (cd "$root" && "$program")
done
