#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs clang-tidy over the sources, and clang's warnings over the sources and the tests. Nothing is built: the preset
# lint has the compile commands.
set -euo pipefail
cd "$(dirname "$0")/.."
cmake --preset lint >/dev/null

tidy() {  # checks, folders
    find "${@:2}" -name '*.cpp' -print0 |
        xargs -0 -P "$(nproc)" -n 4 clang-tidy-16 -p build/lint --quiet --extra-arg=-Wno-unknown-warning-option --checks="$1"
}
tidy '' core geometry engine runner filters formats
tidy '-*,clang-diagnostic-*,bugprone-use-after-move' tests  # it needs one check of its own
