# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares a paper's numbers with ours, from the runs to the page."""
import pathlib
import sys
import tempfile

from harness import machine

from . import page, scanmill


def write(name, options, run, lines_of, tried):
    """Writes NAME.md and NAME.json, prints the page, and returns the exit code: 1 if an entry failed.

    `run(options, folder)` returns the results by name. The results named `tried` are entries with a `file` and a
    `failure`, which is empty after a success. `lines_of(results)` makes the page.
    """
    load = machine.Load()
    try:
        with tempfile.TemporaryDirectory() as folder:
            found = run(options, pathlib.Path(folder))
    except scanmill.Broken as broken:
        sys.exit(f"error: {broken}")
    results = {**page.described("make bench-quality"), "rounds": options.rounds, "load": load.described(), **found}
    lines = lines_of(results)
    print("\n".join(lines))
    page.write(options.into, name, results, lines)
    failed = [entry for entry in found[tried] if entry["failure"]]
    for entry in failed:
        print(f"error: {entry['file']}: {entry['failure']}", file=sys.stderr)
    return 1 if failed else 0
