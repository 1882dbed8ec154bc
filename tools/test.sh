#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the tests of a preset, `test.sh dev -j 8`, and counts the skipped ones by reason. The exit code is that of ctest.
set -uo pipefail
cd "$(dirname "$0")/.."
ctest --preset "$@"
code=$?
# The reason is below "file:line: Skipped". What follows a colon names the test's own file.
awk '/: Skipped$/ { getline; sub(/: .*/, ""); sub(/^needs /, "need "); ++count[$0]; ++all }
     END { for (reason in count) printf "%d %d %s\n", all, count[reason], reason }' \
    "build/$1/Testing/Temporary/LastTest.log" | sort -k 2nr |
    awk '{ all = $1; $1 = ""; list = list (list ? "," : "") $0 }
         END { if (all) print all " tests skipped:" list }'
exit $code
