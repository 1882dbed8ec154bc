#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs every performance bench of a build folder. Each prints its own ratios; the machine comes first. What runs beside
# other programs in processes of their own is peers/run.sh.
set -euo pipefail
build=$1
root=$(cd "$(dirname "$0")/.." && pwd)
echo "machine: $(lscpu | sed -n 's/^Model name: *//p'), $(nproc) cores, load $(cut -d' ' -f1-3 /proc/loadavg), $(date -u +%Y-%m-%d)"
for program in "$build"/bin/*_bench; do
    echo
    echo "== $(basename "$program")"
    (cd "$root" && "$program")
done
