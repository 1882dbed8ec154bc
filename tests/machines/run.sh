#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# run.sh PROGRAM [PART…]: runs exported batches with Snakemake and with Slurm, and compares every result with that of one run, byte for
# byte. The parts are snakemake, slurm, faults, plugin and accounting; without names, all run. A part is skipped, with a sentence, where
# its programs are missing. For Slurm, two nodes are started on this machine, as root.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
program=$(realpath "$1")
shift
parts=" ${*:-snakemake slurm faults plugin accounting} "
folder=$(mktemp -d)
chmod 755 "$folder"
mkdir "$folder/bin" "$folder/slurm"
ln -s "$program" "$folder/bin/scanmill"
export PATH="$folder/bin:$PATH" HOME="$folder"
cd "$folder"

# shellcheck source=tests/machines/slurm.sh
. "$root/tests/machines/slurm.sh"

stop() {
    stop_slurm
    { grep -o " $folder/[^ ]*" /proc/mounts || true; } | xargs -r umount
    rm -rf "$folder"
}
trap stop EXIT

fail() {
    echo "FAILED: $*"
    exit 1
}

passed() { echo "$* ($((SECONDS - since)) s)" && since=$SECONDS; }
since=0

# numbers_of FOLDER: every number of its last run except times and memory.
numbers_of() { scanmill report "$1" --run "$(scanmill runs "$1" --json | sed -n 's/^ *"id": \([0-9]*\).*/\1/p' | tail -1)" --table csv | cut -d, -f3- | grep -vE ',(seconds|cpu-seconds|memory),'; }

# same_result ONE FOLDER: both have the same meshes and descriptions, byte for byte, and the same numbers.
same_result() {
    local file
    for file in "$1"/*.ply "$1"/*.ply.json; do cmp "$file" "$2/$(basename "$file")" || fail "$2 differs"; done
    diff <(numbers_of "$1") <(numbers_of "$2") >difference.txt || fail "the numbers of $2 differ: $(head -5 difference.txt)"
}

# is_status FOLDER STATE CHUNKS: whether these chunks, as 1,3, are all that are in the state.
is_status() {
    scanmill batch --status "$1" >status.txt || true  # 1 if a chunk failed
    grep -q "^$2 .* $3\$" status.txt
}

has_status() { is_status "$@" || fail "$1: chunks $3 are not $2: $(cat status.txt)"; }

# export_batch SCHEDULER BATCH FOLDER [OPTION…]: one scan per chunk, and an empty cache.
export_batch() {
    local cache=(--cache "cache-$3")
    if [[ " $* " == *" --cache "* ]]; then cache=(); fi
    scanmill export "$1" "$2.yaml" -o "$3" --records "one-$2" --minutes 0.001 "${cache[@]}" "${@:4}" >export.txt || fail "export: $(cat export.txt)"
}

# The files of the page on many machines and four scans; a second batch whose last scan takes seconds and 200 MB.
awk '/^<!-- file: /{name=$3} /^```/{if (open) {open=0; name=""} else if (name) {open=1; next}} open{print > name}' "$root/docs/how-to/many-machines.md"
mkdir scans large
for size in 60 80 100 120 300; do
    scanmill run scan.yaml --set size="$size u" -o . -q >/dev/null
    mv scan.ply "$([ "$size" = 300 ] && echo large || echo scans)/$size.ply"
done
sed 's/^batch: .*/batch: large/; s/^scans: .*/scans: ["scans\/60.ply", "large\/*.ply"]/' library.yaml >large.yaml
scanmill batch library.yaml -o one-library -q --no-cache >/dev/null
scanmill batch large.yaml -o one-large -q --no-cache >/dev/null
passed "two batches in one run"

has_part() { [[ $parts == *" $1 "* ]]; }

if has_part snakemake; then . "$root/tests/machines/with_snakemake.sh"; fi
if has_part slurm || has_part faults || has_part plugin || has_part accounting; then
    obstacle=$(slurm_obstacle)
    if [ -n "$obstacle" ]; then
        echo "skipped: the test with Slurm $obstacle"
        exit 0
    fi
fi
if has_part slurm || has_part faults || has_part plugin; then start_slurm; fi
if has_part slurm; then . "$root/tests/machines/with_slurm.sh"; fi
if has_part faults; then . "$root/tests/machines/with_faults.sh"; fi
if has_part plugin || has_part accounting; then . "$root/tests/machines/with_plugin.sh"; fi
