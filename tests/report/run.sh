#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the report page and the inspection sheet, and tests them in headless Chromium. Skipped, with a sentence, without Node or Chromium.
set -euo pipefail
cd "$(dirname "$0")"
report=../../report

if ! command -v node >/dev/null || ! command -v npm >/dev/null; then
    echo "skipped: the tests of the report page need Node and npm"
    exit 0
fi
chromium=${CHROMIUM:-$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)}
if [ -z "$chromium" ]; then
    echo "skipped: the tests of the report page need Chromium; set CHROMIUM to its path"
    exit 0
fi
export CHROMIUM=$chromium

# Installs what the lock file lists, if it was not installed since.
install() {
    [ "$1/node_modules/.package-lock.json" -nt "$1/package-lock.json" ] || npm --prefix "$1" ci --no-fund --no-audit --silent
}
install $report
install .

npm --prefix $report run --silent check
$report/node_modules/.bin/tsc -p .
npm --prefix $report run --silent build
$report/node_modules/.bin/esbuild make_data.ts --bundle --platform=node --format=esm --outfile=build/make_data.mjs --log-level=warning
node build/make_data.mjs $report/dist/page.html $report/dist/sheet.html build/pages
node --test --test-reporter=spec page_test.mjs sheet_test.mjs
