#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""wang_tables.py PROGRAM: the numbers of chapters 3 and 4 of Wang 2006 beside ours.

Makes the thesis's clouds by their formulas, thins them to its tolerances (wang-thinning.yaml), and takes every case of
section 4.4, or what stands for it, through the workflow to features, ROUNDS times with one thread and with all,
without a cache. Every number is from the program's own JSON (metrics and seconds of the steps, features as they were
written) or a closed form. Writes wang-tables.md and .json. Ends with 1 when a run failed, or a fetched file is missing.
"""
import pathlib
import sys

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

import paper_wang as thesis  # noqa: E402
import wang_cases  # noqa: E402
import wang_clouds  # noqa: E402
import wang_page  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import paper, scanmill  # noqa: E402

ROOT = BENCH.parent


def arguments():
    return options_of.of_a_paper("The thesis's numbers beside ours.", None).parse_args()


def thinned(report):
    """By the variant's settings: the bin size and how many points it kept."""
    found = {}
    for cell in report["cells"]:
        if cell["outcome"] != "done":
            raise scanmill.Broken(f"{cell['scan']}: {cell.get('error', cell['outcome'])}")
        step = scanmill.steps(report, cell)["voxel-thin"]
        settings = step["parameters"]
        found[f"{settings['derivatives']}, {settings['origin']}"] = {
            "bin_size": step["metrics"]["bin-size"], "kept": int(step["metrics"]["kept"])}
    return found


def clouds_in(folder):
    """Files of the thesis's clouds, by name."""
    files = {}
    for name, make in wang_clouds.CLOUDS.items():
        files[name] = folder / f"{name}.xyz"
        wang_clouds.write(make(), files[name])
    return files


def measured_thinning(options, files, folder):
    found = {}
    for line in (thesis.HEMISPHERE, thesis.CONE, thesis.HYPERBOLOID):
        report = scanmill.run(options.program, BENCH / "quality" / "wang-thinning.yaml", [files[line.cloud]],
                              folder / f"thinned-{line.cloud}", options.limit,
                              settings={"tolerance": f"{line.tolerance} u"})
        found[line.cloud] = thinned(report)
    return found


def keeping(options, file, folder):
    """A function: how many points bins of a size keep."""
    def kept(bin_size):
        report = scanmill.run(options.program, BENCH / "quality" / "wang-binning.yaml", [file],
                              folder / f"{file.stem}-{bin_size}", options.limit, settings={"bin-size": f"{bin_size} u"})
        return int(scanmill.steps(report, report["cells"][0])["voxel-thin"]["metrics"]["kept"])
    return kept


def bin_that_keeps(count, kept, low, high, steps=8):
    """By bisection: bins of `low` keep more points than `count`, those of `high` not more. The number need not fall
    evenly, so this is one such size."""
    for _ in range(steps):
        middle = (low + high) / 2
        low, high = (middle, high) if kept(middle) > count else (low, middle)
    return high


def kept_by_bins(options, file, line, folder):
    """By bins of the printed size, and the size of bins that keep the printed number."""
    kept = keeping(options, file, folder)
    return {"kept": kept(line.bin_size),
            "bin_size": bin_that_keeps(line.kept, kept, line.bin_size / 3, line.bin_size * 3)}


def run(options, folder):
    files = clouds_in(folder)
    return {
        "points": {name: len(make()) for name, make in wang_clouds.CLOUDS.items()},
        "thinning": measured_thinning(options, files, folder),
        "binning": {line.cloud: kept_by_bins(options, files[line.cloud], line, folder)
                    for line in (thesis.HEMISPHERE, thesis.HYPERBOLOID)},
        "cases": wang_cases.run(options, files["hyperboloid"], folder),
    }


def main():
    return paper.write("wang-tables", arguments(), run, wang_page.lines, tried="cases")


if __name__ == "__main__":
    sys.exit(main())
