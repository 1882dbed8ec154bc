#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# python_environment.sh REQUIREMENTS FOLDER: creates a Python environment with the packages of the file REQUIREMENTS in FOLDER and
# prints the path of its interpreter. Does not change an environment that already has these packages.
set -euo pipefail
wanted=$1
folder=$2
if ! cmp -s "$wanted" "$folder/requirements.txt"; then
    python3 -m venv --clear "$folder"
    "$folder/bin/pip" install --quiet --disable-pip-version-check -r "$wanted"
    cp "$wanted" "$folder/requirements.txt"
fi
echo "$folder/bin/python"
