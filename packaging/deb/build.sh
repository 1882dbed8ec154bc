#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# build.sh BUILD DIST: makes the .deb of the program in the build folder BUILD, and writes it to DIST.
set -euo pipefail
build=$(realpath "$1")
mkdir -p "$2"
dist=$(realpath "$2")
work=$build/packaging/deb
if [ ! -e "$build/share/scanmill/report/page.html" ]; then
    echo "error: $build has no report page, which needs Node and npm; install them and build again" >&2
    exit 1
fi
umask 022
rm -rf "$work"
cpack --config "$build/CPackConfig.cmake" -B "$work" >"$build/packaging/cpack.log" 2>&1 || { cat "$build/packaging/cpack.log" >&2; exit 1; }
for package in "$work"/scanmill_*.deb; do
    name=$(basename "$package")
    rm -f "$dist"/scanmill_*.deb
    mv "$package" "$dist/"
    echo "$2/$name: $(numfmt --to=si --suffix=B "$(stat -c %s "$dist/$name")")"
done
