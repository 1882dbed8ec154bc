#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# run.sh BUILD [options of run.py]: creates the Python environment in build/peers/python, then runs the rows.
set -euo pipefail
here=$(dirname "$0")
python=$("$here/../../tools/python_environment.sh" "$here/requirements.txt" "$(dirname "$1")/peers/python")
exec "$python" "$here/run.py" "$@"
