#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Writes schemas/, the generated parts of the pages in docs/ and filters/, and bench/RESULTS.md, which marks the results of
# older versions of filters, with the built program: `generate.sh build/dev`. With `check` as second argument it changes
# nothing, and fails if the committed files differ from the filters' declarations. If the program lacks a filter of this
# tree, nothing is written.
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
    echo "error: '$program' lacks ${missing[*]}, which have pages here" >&2
    echo "hint: cmake --build $build --target ${missing[*]}" >&2
    exit 1
fi

# The pages with generated parts, and every filter's page.
mapfile -t pages < <(grep -rl --include='*.md' '^<!-- generated: ' docs filters | sort)
for folder in filters/*/; do
    grep -qx "<!-- generated: filter $(basename "${folder//_/-}") -->" "${folder}README.md" && continue
    echo "error: '${folder}README.md' lacks the generated part about its filter" >&2
    echo "hint: write '<!-- generated: filter $(basename "${folder//_/-}") -->' and '<!-- end -->' into it" >&2
    exit 1
done

made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
"$program" schema -o "$made/schemas"
cp --parents "${pages[@]}" "$made"
(cd "$made" && "$program" docs --update "${pages[@]}")
results() {  # from the versions in the filters' pages
    [ -f bench/results.json ] || return 0
    mkdir -p "$made/bench"
    cp bench/results.json "$made/bench"
    python3 -B bench/peers/run.py "$build" --only-table --into "$made/bench"
}
if [ "${2:-}" = check ]; then
    differs=0
    diff -ru --exclude=workflow.schema.json schemas "$made/schemas" || differs=1
    for page in "${pages[@]}"; do diff -u "$page" "$made/$page" || differs=1; done
    if [ $differs = 1 ]; then
        echo "error: schemas/ or the generated parts of pages are not what the filters declare; run: make generate" >&2
        exit 1
    fi
    results
    if [ -f bench/results.json ] && ! diff -u bench/RESULTS.md "$made/bench/RESULTS.md"; then
        echo "error: bench/RESULTS.md does not mark the results of older versions of filters; run: make generate" >&2
        exit 1
    fi
else
    cp -r "$made/schemas" .
    for page in "${pages[@]}"; do cmp -s "$page" "$made/$page" || cp "$made/$page" "$page"; done
    results
    [ ! -f bench/results.json ] || cp "$made/bench/RESULTS.md" bench
fi
