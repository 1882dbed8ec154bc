# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the rows and writes results.json and RESULTS.md: run.py BUILD [options].

The exit code is 1 if one of our contenders failed, if an input is missing, or if our result differs from that of all
other programs. Failures and wrong results of other programs are only recorded.
"""
import argparse
import datetime
import importlib
import json
import pathlib
import signal
import sys

import programs
from harness import machine, table, turns
from harness.inputs import Inputs
from harness.process import Failure, Process

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE.parent))

from tables.options import at_least_one, limit  # noqa: E402


def arguments():
    parser = argparse.ArgumentParser(description="Compares Scanmill with other programs.")
    parser.add_argument("build", type=pathlib.Path, help="a build folder of the preset bench")
    parser.add_argument("--rows", default="", help="parts of row names, separated by commas (default: all rows)")
    parser.add_argument("--rounds", type=at_least_one, help="counted rounds (default: set by each row)")
    parser.add_argument("--large", action="store_true", help="also the rows that take minutes and gigabytes")
    limit(parser, 300, "one answer")
    parser.add_argument("--budget", type=float, default=20, help="seconds of work per contender (default: %(default)s)")
    parser.add_argument("--into", type=pathlib.Path,
                        help="folder of the results (default: bench for all rows, else build/peers)")
    parser.add_argument("--merge", action="store_true",
                        help="put the chosen rows into bench/results.json, with their own date and revision")
    parser.add_argument("--only-table", action="store_true", help="measure nothing; write RESULTS.md from results.json")
    parser.add_argument("--list", action="store_true", help="print the names of the rows and stop")
    return parser.parse_args()


def all_rows(inputs, large):
    rows = []
    for file in sorted((HERE / "rows").glob("[!_]*.py")):
        rows += importlib.import_module(f"rows.{file.stem}").rows(inputs, large)
    return rows


def chosen(rows, wanted):
    """The rows whose name contains one of the words. Exits if no row matches a word."""
    words = [word for word in wanted.replace(",", " ").split() if word]
    for word in words:
        if not any(word in row.name for row in rows):
            sys.exit(f"error: there is no row '{word}'; the rows are {', '.join(row.name for row in rows)}")
    return [row for row in rows if not words or any(word in row.name for word in words)]


def versions(rows, build, limit):
    """The versions that the programs report, and the compiler. A program that reports none is left out here and fails
    in its row."""
    found = {}
    for name in sorted({contender.program for row in rows for contender in row.contenders}):
        process = None
        try:
            process = Process(programs.command(name, build))
            found.update(process.ask({"do": "versions"}, limit))
        except Failure as failure:
            print(f"{name}: {failure}", file=sys.stderr)
        finally:
            if process:
                process.close()
    return found


def trouble(record):
    """The reasons why this row is invalid, as sentences; empty if it is valid."""
    if record["failure"]:
        return [record["failure"]]
    entries = record["contenders"]
    ours = []
    for entry in entries:
        if entry["ours"] and (entry["failure"] or entry["unequal"]):
            ours.append(f"{entry['name']}: {entry['failure'] or entry['unequal']}")
    others = [entry for entry in entries if not entry["ours"] and entry["checked"]]
    if others and all(entry["unequal"] for entry in others) and any(entry["ours"] for entry in entries):
        ours.append("our result differs from that of every other program: " + others[0]["unequal"])
    return ours


def write(folder, results):
    """Writes both files, each whole or not at all."""
    text = json.dumps(results, indent=1, allow_nan=False) + "\n"
    for name, content in (("results.json", text), ("RESULTS.md", table.page(results))):
        part = folder / (name + ".part")
        part.write_text(content)
        part.replace(folder / name)


def merged(old, new, names):
    """The old results with the new rows in the place that `names` gives them; each has its own date and revision."""
    rows = {row["name"]: row for row in old["rows"]}
    for row in new["rows"]:
        rows[row["name"]] = {**row, "date": new["date"], "revision": new["revision"]}
    return {**old, "rows": [rows[name] for name in names if name in rows]}


def main():
    options = arguments()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # ends the child processes and removes the temporary files
    made = options.build.resolve().parent / "peers"
    inputs = Inputs(ROOT / "build" / "data", made / "inputs", options.build / "bin" / "peer_inputs")
    every = all_rows(inputs, options.large)
    rows = chosen(every, options.rows)
    if options.list:
        print("\n".join(row.name for row in rows))
        return 0
    into = options.into or (ROOT / "bench" if len(rows) == len(every) else made)
    if options.only_table:
        write(into, json.loads((into / "results.json").read_text()))
        return 0
    results = {
        "format": 1,
        "command": "make bench-peers" + (" LARGE=1" if options.large else "")
        + (f" ROWS={options.rows}" if options.rows else "") + (f" ROUNDS={options.rounds}" if options.rounds else ""),
        "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
        "revision": machine.revision(ROOT),
        "machine": machine.described(),
        "limit_seconds": options.limit,
        "budget_seconds": options.budget,
        "versions": versions(rows, options.build, options.limit),
        "rows": [],
    }
    how = turns.Options(options.rounds, options.limit, options.budget)
    failed = []
    for row in rows:
        record = turns.run(row, lambda program: programs.command(program, options.build), how)
        results["rows"].append(record)
        print("\n".join(table.section(record)), flush=True)
        failed += [f"{row.name}: {why}" for why in trouble(record)]
    if options.merge:
        into = options.into or ROOT / "bench"
        names = [row.name for row in all_rows(inputs, True)]
        results = merged(json.loads((into / "results.json").read_text()), results, names)
    into.mkdir(parents=True, exist_ok=True)
    write(into, results)
    print(f"written: {into / 'results.json'}, {into / 'RESULTS.md'}")
    for why in failed:
        print(f"error: {why}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
