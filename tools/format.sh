#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Formats every C++ file. `format.sh check` changes nothing; it lists the files that differ and fails if there are any.
set -euo pipefail
cd "$(dirname "$0")/.."
mapfile -d '' files < <(find . -path ./build -prune -o \( -name '*.cpp' -o -name '*.hpp' \) -print0)
if [ "${1:-}" = check ]; then
    clang-format-16 --dry-run --Werror "${files[@]}"
else
    clang-format-16 -i "${files[@]}"
fi
