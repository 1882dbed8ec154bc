#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Writes schemas/ and docs/filters/ with the built program: `generate.sh build/dev`. With `check` as second argument it
# changes nothing and fails when the committed files differ from what the filters declare.
set -euo pipefail
program=$(realpath "$1")/bin/scanmill
cd "$(dirname "$0")/.."

into=.
if [ "${2:-}" = check ]; then
    into=$(mktemp -d)
    trap 'rm -rf "$into"' EXIT
fi
rm -rf "$into/docs/filters"
# Only the filters of this tree: not what SCANMILL_PLUGIN_PATH adds.
unset SCANMILL_PLUGIN_PATH
"$program" schema -o "$into/schemas"
"$program" docs -o "$into/docs/filters"
[ "$into" = . ] && exit 0
if ! diff -ru schemas "$into/schemas" || ! diff -ru docs/filters "$into/docs/filters"; then
    echo "error: schemas/ or docs/filters/ are not what the filters declare; run: make generate" >&2
    exit 1
fi
