# shellcheck shell=bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Snakemake on this machine; run.sh reads this file.

if ! command -v snakemake >/dev/null; then
    echo "skipped: the test with Snakemake needs snakemake"
    return
fi
export_batch snakemake library with-snakemake
snakemake -s with-snakemake/Snakefile -j 2 >snakemake.txt 2>&1 || fail "snakemake: $(tail -5 snakemake.txt)"
same_result one-library with-snakemake/result
[ -s with-snakemake/result/report.html ] || echo "no report page: this program was built without it"
passed "snakemake: 8 cells in chunks give the results of one run"

export_batch snakemake library without-program --program no-scanmill
snakemake -s without-program/Snakefile -j 2 --retries 0 >snakemake.txt 2>&1 && fail "a missing program is not noticed"
grep -q 'cannot run no-scanmill; install' without-program/logs/0001.txt || fail "a missing program: $(cat without-program/logs/0001.txt)"
passed "snakemake, without the program: one sentence names the way out"

ln -s scanmill "$folder/bin/no-scanmill"
scanmill batch --status without-program >status.txt && fail "a failed chunk is not noticed: $(cat status.txt)"
again=$(grep -o 'rm -f .*' status.txt) || fail "no command runs the failed chunks again: $(cat status.txt)"
sh -c "$again" >snakemake.txt 2>&1 || fail "snakemake, again: $(tail -5 snakemake.txt)"
rm "$folder/bin/no-scanmill"
same_result one-library without-program/result
passed "snakemake, with the program: the command of --status gives the results of one run"
