#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Counts the lines of C++ code of each library, without blank lines and comments: of the working tree, or of a revision,
# `code_lines.sh v1.0`.
set -euo pipefail
cd "$(dirname "$0")/.."
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
folders=(core geometry engine runner formats filters)
if [ $# -gt 0 ]; then
    git archive "$1" | tar -x -C "$tree"
else
    cp -r "${folders[@]}" "$tree"
fi
cd "$tree"
for folder in "${folders[@]}"; do
    [ ! -d "$folder" ] || find "$folder" \( -name '*.cpp' -o -name '*.hpp' \) -exec cat {} +  |
        grep -vcE '^[[:space:]]*(//.*|/\*.*\*/[[:space:]]*)?$' | sed "s/$/ $folder/"
done | awk '{ print; all += $1 } END { print all " total" }' | column -t -R 1
