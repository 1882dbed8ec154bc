#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""wang_tables.py PROGRAM: compares the numbers of chapters 3 to 5 of Wang 2006 with ours.

Makes the thesis's clouds by their formulas and thins them to its tolerances (wang-thinning.yaml). Runs the workflow to
features on every case of section 4.4, or on a similar scan, ROUNDS times with one thread and with all threads, without
a cache. Plans the touches of the bodies of tables 5.1 and 5.2 (wang-probing.yaml). Every number comes from the
program's JSON (metrics and seconds of the steps, the written features and plans) or from a closed form. Writes
wang-tables.md and .json. The exit code is 1 if a run failed or a fetched file is missing.
"""
import pathlib
import sys

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

import paper_wang as thesis  # noqa: E402
import wang_cases  # noqa: E402
import wang_clouds  # noqa: E402
import wang_page  # noqa: E402
import wang_probing  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import paper, scanmill  # noqa: E402

ROOT = BENCH.parent


def arguments():
    return options_of.of_a_paper("Compares the thesis's numbers with ours.", None).parse_args()


def thinned(report):
    """The voxel size and the number of kept points, by the settings of the variant."""
    found = {}
    for cell in report["cells"]:
        if cell["outcome"] not in ("ok", "doubtful"):
            raise scanmill.Broken(f"{cell['scan']}: {cell.get('error', cell['outcome'])}")
        step = scanmill.steps(report, cell)["voxel-thin"]
        settings = step["parameters"]
        found[f"{settings['derivatives']}, {settings['origin']}"] = {
            "bin_size": step["metrics"]["bin-size"], "kept": int(step["metrics"]["kept"])}
    return found


def clouds_in(folder):
    """Writes the thesis's clouds; returns the files by name."""
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
    """Returns a function from a voxel size to the number of kept points."""
    def kept(bin_size):
        report = scanmill.run(options.program, BENCH / "quality" / "wang-binning.yaml", [file],
                              folder / f"{file.stem}-{bin_size}", options.limit, settings={"bin-size": f"{bin_size} u"})
        return int(scanmill.steps(report, report["cells"][0])["voxel-thin"]["metrics"]["kept"])
    return kept


def bin_that_keeps(count, kept, low, high, steps=8):
    """A voxel size that keeps `count` points, by bisection. Voxels of `low` keep more points, voxels of `high` do not.
    The number is not monotonic, so other sizes may exist."""
    for _ in range(steps):
        middle = (low + high) / 2
        low, high = (middle, high) if kept(middle) > count else (low, middle)
    return high


def kept_by_bins(options, file, line, folder):
    """The number of points kept with the printed voxel size, and the voxel size that keeps the printed number."""
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
        "probing": wang_probing.run(options, folder),
    }


def main():
    return paper.write("wang-tables", arguments(), run, wang_page.lines, tried="cases")


if __name__ == "__main__":
    sys.exit(main())
