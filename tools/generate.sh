#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Writes schemas/ and docs/filters/ with the built program: `generate.sh build/dev`, and bench/RESULTS.md, which marks the
# results of older versions of filters. With `check` as second argument it changes nothing, and fails if the committed files
# differ from the filters' declarations. If the program lacks a filter of this tree, that filter would lose its page; nothing
# is written then.
set -euo pipefail
build=$1
program=$(realpath "$build")/bin/scanmill
cd "$(dirname "$0")/.."
# Only the filters of this tree, without those of SCANMILL_PLUGIN_PATH.
unset SCANMILL_PLUGIN_PATH

known=$("$program" list | cut -d ' ' -f 1)
missing=()
for folder in $(sed -n 's/^ *scanmill_add_filter(\([a-z0-9_]*\).*/\1/p' filters/CMakeLists.txt); do
    grep -qx -- "${folder//_/-}" <<<"$known" || missing+=("scanmill-${folder//_/-}")
done
if [ ${#missing[@]} -gt 0 ]; then
    echo "error: '$program' lacks ${missing[*]}, whose pages would be lost" >&2
    echo "hint: cmake --build $build --target ${missing[*]}" >&2
    exit 1
fi

made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
"$program" schema -o "$made/schemas"
"$program" docs -o "$made/docs/filters"
results() {  # from the pages in docs/filters
    [ -f bench/results.json ] || return 0
    mkdir -p "$made/bench"
    cp bench/results.json "$made/bench"
    python3 -B bench/peers/run.py "$build" --only-table --into "$made/bench"
}
if [ "${2:-}" = check ]; then
    if ! diff -ru --exclude=workflow.schema.json schemas "$made/schemas" || ! diff -ru docs/filters "$made/docs/filters"; then
        echo "error: schemas/ or docs/filters/ are not what the filters declare; run: make generate" >&2
        exit 1
    fi
    results
    if [ -f bench/results.json ] && ! diff -u bench/RESULTS.md "$made/bench/RESULTS.md"; then
        echo "error: bench/RESULTS.md does not mark the results of older versions of filters; run: make generate" >&2
        exit 1
    fi
else
    rm -rf docs/filters
    cp -r "$made/schemas" "$made/docs" .
    results
    [ ! -f bench/results.json ] || cp "$made/bench/RESULTS.md" bench
fi
