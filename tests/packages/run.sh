#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# run.sh [TEST…]: tests the packages in dist/ in root file systems of their own, which it keeps in build/packages/roots or
# $SCANMILL_PACKAGE_ROOTS. Needs root. Mounts end with the script.
set -euo pipefail
cd "$(dirname "$0")"
if [ "$(id -u)" != 0 ]; then
    echo "skipped: the tests of packages need root, for chroot and mount"
    exit 0
fi
exec unshare --mount --propagation private python3 -B -m unittest -v "${@:-packages_test}"
