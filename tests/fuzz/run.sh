#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# run.sh BUILD SECONDS [TARGET…]: feeds each target of the fuzzer in a build folder for so long, one after the other, and
# stops at the first finding with the path of what caused it. What is learned stays in BUILD/corpus for the next time.
set -euo pipefail
build=$(realpath "$1") seconds=$2
shift 2
fuzz=$(realpath "$(dirname "$0")")
targets=("$@")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(ls "$fuzz/corpus")
export ASAN_SYMBOLIZER_PATH=${ASAN_SYMBOLIZER_PATH:-$(command -v llvm-symbolizer-16 || true)}
# Refusals are exceptions, and those are slow with the first of these.
export ASAN_OPTIONS=detect_stack_use_after_return=0:malloc_context_size=10

"$build/bin/write_seeds" "$build/seeds"
for target in "${targets[@]}"; do
    mkdir -p "$build/corpus/$target" "$build/findings" "$build/seeds/$target"
    seeds=("$fuzz/corpus/$target" "$build/seeds/$target")
    case $target in
        workflow | batch | setting | manifest | format-manifest | poses | document) ;;
        *) seeds+=("$fuzz/../data") ;; # broken scans of every format
    esac
    words=()
    [ ! -f "$fuzz/$target.dict" ] || words=(-dict="$fuzz/$target.dict")
    log=$build/findings/$target.log
    echo "$target: $seconds seconds"
    if ! SCANMILL_FUZZ_TARGET=$target nice -n 15 "$build/bin/scanmill-fuzz" "${words[@]}" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 \
        -malloc_limit_mb=256 -max_len=8192 -print_final_stats=1 -artifact_prefix="$build/findings/$target-" \
        "$build/corpus/$target" "${seeds[@]}" >"$log" 2>&1; then
        tail -n 60 "$log"
        echo "error: a finding in $target; its log is '$log', what caused it:" >&2
        sed -n "s/^artifact_prefix.*written to /  /p; s/^.*Test unit written to /  /p" "$log" | sort -u >&2
        exit 1
    fi
    grep -E '^#[0-9]+.(DONE|pulse|REDUCE|NEW)' "$log" | tail -n 1
    grep -E 'INFO: Loaded|Done|executions|new_units' "$log" | grep -v Loaded.*libs || true
done
