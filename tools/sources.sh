#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Fetches the sources of two libraries that Debian 12 does not have into build/sources and checks their SHA-256. They come
# inside packages of PyPI and must not be committed. Existing sources are not fetched again.
#
#   build/sources/laszip   LASzip, which reads and writes LAZ (Apache-2.0)
#   build/sources/pye57    libE57Format, which reads E57 (BSL-1.0)
set -euo pipefail

sources=$(cd "$(dirname "$0")/.." && pwd)/build/sources
mkdir -p "$sources"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fetch() { # package, version, SHA-256 of its source archive
    local archive=$work/$1-$2.tar.gz
    [ ! -e "$sources/$1/$2" ] || return 0
    echo "fetching the sources of $1 $2"
    # Only the package itself comes as source; what pip needs to read its version may be built already.
    python3 -m pip download --quiet --no-deps --no-binary "$1" --dest "$work" "$1==$2" >/dev/null \
        || { echo "error: PyPI's package $1 $2 could not be fetched" >&2; return 1; }
    echo "$3  $archive" | sha256sum --check --status \
        || { echo "error: $(basename "$archive") is not the expected file (SHA-256 differs)" >&2; return 1; }
    rm -rf "${sources:?}/$1"
    mkdir "$work/$1"
    tar -xzf "$archive" -C "$work/$1" --strip-components=1
    touch "$work/$1/$2"
    mv "$work/$1" "$sources/$1"
}

# Both at once: pip takes most of a minute for each.
fetch laszip 0.3.0 9ddf91649b519db308f63d772a19e7647458f5d5512e3d927629f0196b9c6216 &
fetch pye57 0.4.19 0323a0cb5e62286fb3f4d7a2c63d811bb813ac65e2a21cfadf8ca848eaa27101
wait $!
