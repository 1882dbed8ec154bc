#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# environment.sh FOLDER: makes a Python environment with the peers of requirements.txt there, and says where its
# interpreter is. Does nothing when the folder holds them already.
set -euo pipefail
folder=$1
wanted=$(dirname "$0")/requirements.txt
if ! cmp -s "$wanted" "$folder/requirements.txt"; then
    python3 -m venv --clear "$folder"
    "$folder/bin/pip" install --quiet --disable-pip-version-check -r "$wanted"
    cp "$wanted" "$folder/requirements.txt"
fi
echo "$folder/bin/python"
