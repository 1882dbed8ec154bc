# SPDX-License-Identifier: GPL-3.0-or-later
"""Options that the command lines of the benches share."""
import argparse
import pathlib

BENCH = pathlib.Path(__file__).resolve().parents[1]


def at_least_one(text):
    """A type for argparse: a whole number of at least 1."""
    try:
        number = int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number") from None
    if number < 1:
        raise argparse.ArgumentTypeError(f"must be at least 1, not {number}")
    return number


def limit(parser, seconds, what):
    parser.add_argument("--limit", type=float, default=seconds, help=f"seconds for {what} (default: %(default)s)")


def of_a_table(description, workflow, seconds, folder):
    """A parser for a bench that runs a workflow over scans and writes a page into a folder of bench/. `workflow` is the
    default of --workflow; None omits this option. `seconds` is the default time limit of one run."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("program", type=pathlib.Path, help="the program scanmill, with its filters")
    if workflow:
        parser.add_argument("--workflow", type=pathlib.Path, default=workflow)
    parser.add_argument("--data", type=pathlib.Path, default=BENCH.parent / "build" / "data",
                        help="the folder that `make data` fills")
    limit(parser, seconds, "one run")
    parser.add_argument("--into", type=pathlib.Path, default=BENCH / folder, help="folder of the results")
    return parser


def of_a_paper(description, workflow):
    """A parser for a bench that compares a paper's numbers with ours: see paper.py."""
    parser = of_a_table(description, workflow, 600, "quality")
    parser.add_argument("--more-data", type=pathlib.Path, default=BENCH.parents[1] / "shared" / "data",
                        help="folder of optional files (default: %(default)s)")
    parser.add_argument("--rounds", type=at_least_one, default=5,
                        help="runs per number of threads (default: %(default)s)")
    return parser
