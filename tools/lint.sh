#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs clang-tidy over the sources, with the compile commands of a configured build folder.
set -euo pipefail
build=$1
cd "$(dirname "$0")/.."
find core engine runner filters -name '*.cpp' -print0 | xargs -0 -P "$(nproc)" -n 4 clang-tidy-16 -p "$build" --quiet
