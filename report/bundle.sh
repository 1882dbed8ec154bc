#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# bundle.sh SOURCE WORK PAGE: bundles the pages in the folder WORK, and writes the report page to PAGE and the inspection sheet to
# sheet.html in the folder of PAGE. Where npm cannot fetch the packages, a warning says so, and the program is built without both.
set -eu
mkdir -p "$2" "$(dirname "$3")"
cd "$2"
rm -rf src dist
cp -R "$1/src" "$1/build.mjs" "$1/package.json" "$1/package-lock.json" "$1/tsconfig.json" .
cp "$1/.npmrc" . 2>/dev/null || true
# The packages stay while the lock file does.
if ! cmp -s package-lock.json node_modules/.bundled-lock.json; then
    npm ci --silent --no-audit --no-fund || {
        echo "warning: npm cannot fetch the packages of the report page and the inspection sheet, which are left out; build again to retry" >&2
        exit 0
    }
    cp package-lock.json node_modules/.bundled-lock.json
fi
npm run --silent build
cp dist/page.html "$3"
cp dist/sheet.html "$(dirname "$3")/sheet.html"
