# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares a paper's numbers with ours, from the runs to the page."""
import pathlib
import sys
import tempfile

from harness import machine

from . import page, scanmill


def take(entry, judgement, threads):
    """Adds one run to an entry. Only seconds may differ between runs."""
    if judgement.get("failure"):
        entry["failure"] = judgement["failure"]
        return
    counts = {name: value for name, value in judgement.items() if name != "seconds"}
    different = [name for name, value in counts.items() if "seconds" in entry and entry[name] != value]
    if different:
        raise scanmill.Broken(f"{entry['file']}: two runs gave different {', '.join(different)}")
    entry.update(counts)
    entry.setdefault("seconds", {}).setdefault(threads, []).append(judgement["seconds"])


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
