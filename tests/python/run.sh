#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# run.sh BUILD PYTHON [TEST…]: tests the Python package in the folder BUILD/python with the interpreter PYTHON. Without BUILD/python,
# tests the package that PYTHON has installed.
set -euo pipefail
build=$(realpath "$1")
python=$(realpath -s "$2")
shift 2
cd "$(dirname "$0")"
[ ! -d "$build/lib/scanmill/test-plugins" ] || export SCANMILL_PLUGIN_PATH=$build/lib/scanmill/test-plugins
[ ! -d "$build/python" ] || export PYTHONPATH=$build/python
[ $# -gt 0 ] || set -- discover -p "*_test.py"
exec "$python" -B -m unittest "$@"
