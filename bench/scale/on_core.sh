#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# on_core.sh ARGUMENT…: runs scanmill as a node with one core does, and appends node, begin and end in seconds to the file TIMES.
number=${SLURMD_NODENAME#node}
begin=$(date +%s.%N)
taskset -c $(((number - 1) % $(nproc --all))) scanmill "$@"
code=$?
echo "$SLURMD_NODENAME $begin $(date +%s.%N)" >>"$TIMES"
exit $code
