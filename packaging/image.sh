#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# image.sh DIST: makes a root file system of Debian 12 with the .deb in DIST, DIST/scanmill-VERSION-image.tar.gz, for
#
#     podman import --change 'ENTRYPOINT ["scanmill"]' --change 'WORKDIR /work' DIST/scanmill-VERSION-image.tar.gz scanmill
#     podman run --rm --user "$(id -u):$(id -g)" -e HOME=/tmp -v "$PWD:/work" scanmill run quickstart scan.ply
#
# The image has Debian 12 and the .deb with its libraries.
set -euo pipefail
dist=$(realpath "$1")
package=$(ls "$dist"/scanmill_*.deb)
version=$(dpkg-deb -f "$package" Version)
image=$dist/scanmill-${version%-*}-image.tar.gz
rm -f "$dist"/scanmill-*-image.tar.gz
log=$(mktemp)
trap 'rm -f "$log"' EXIT
# Documentation and translations are left out, licences are not.
# shellcheck disable=SC2016  # $1 is the hook's
mmdebstrap --variant=minbase --mode=auto \
    --dpkgopt='path-exclude=/usr/share/doc/*' --dpkgopt='path-include=/usr/share/doc/*/copyright' \
    --dpkgopt='path-include=/usr/share/doc/scanmill/*' \
    --dpkgopt='path-exclude=/usr/share/man/*' --dpkgopt='path-exclude=/usr/share/locale/*' \
    --hook-dir=/usr/share/mmdebstrap/hooks/file-mirror-automount \
    --include="$package" --customize-hook='mkdir -p "$1/work"; chmod 1777 "$1/work"' \
    bookworm "$image" >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
echo "$1/$(basename "$image"): $(numfmt --to=si --suffix=B "$(stat -c %s "$image")")"
