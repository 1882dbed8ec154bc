#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""robustness.py PROGRAM: measures how much noise and how few points the reconstruction tolerates.

Samples seeded points on known surfaces, runs the program once per surface, and judges every scan by the program's
report (see verdict.py). Writes results.json and results.md. The exit code is 1 if the program crashed or an input is
missing. Wrong results and refusals are results of this bench and do not change the exit code.
"""
import os
import pathlib
import sys
import tempfile

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

import sampling  # noqa: E402
import shapes  # noqa: E402
import summary  # noqa: E402
import verdict  # noqa: E402
from harness import machine  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import page, scanmill  # noqa: E402
from tables.ply import write_ply  # noqa: E402

NOISE = (0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1, 1.5, 2)
POINTS = (100, 200, 500, 1000, 2000, 5000, 10000)
POINTS_WITH_NOISE = 3000


def arguments():
    parser = options_of.of_a_table("Success rates of the reconstruction by noise and density.",
                                   BENCH / "robustness" / "reconstruction.yaml", 1800, "robustness")
    parser.add_argument("--seeds", type=options_of.at_least_one, default=5,
                        help="trials per cell (default: %(default)s)")
    return parser.parse_args()


def surfaces(data):
    bunny = data / "meshes" / "bunny00.off"
    if not bunny.exists():
        sys.exit(f"error: {bunny} is not there; `make data` fetches it")
    return [shapes.sphere(), shapes.torus(), shapes.block(),
            shapes.from_off("bunny", "a closed mesh of the scan", 0, bunny)]


def write_scan(folder, trial, points):
    path = folder / f"{trial['axis']}-{trial['level']:g}-{trial['seed']}.ply"
    write_ply(path, points)
    trial["points"] = len(points)
    return str(path)


def scans(shape, seeds, folder):
    """Writes all clouds of a shape. Returns the trials before the run, by path."""
    found = {}
    for seed in range(1, seeds + 1):
        points, spacing = sampling.spread(shape, POINTS_WITH_NOISE, seed)
        for level in NOISE:
            moved, largest = sampling.with_noise(points, level * spacing, seed)
            trial = {"shape": shape.name, "axis": "noise", "level": level, "seed": seed, "spacing": float(spacing),
                     "bound": verdict.bound(float(spacing)), "farthest_move": largest}
            found[write_scan(folder, trial, moved)] = trial
        for count in POINTS:
            points_of_count, spacing_of_count = sampling.spread(shape, count, seed)
            trial = {"shape": shape.name, "axis": "density", "level": count, "seed": seed,
                     "spacing": float(spacing_of_count), "bound": verdict.bound(float(spacing_of_count)),
                     "farthest_move": 0.0}
            found[write_scan(folder, trial, points_of_count)] = trial
    return found


def fill_in(trial, report, cell, genus):
    """Adds the results of one scan to its trial."""
    steps = scanmill.named(report, cell)
    names = ("alpha-solid", "sculpt", "before-sculpting", "sculpted")
    solid, carved, before, metrics = (steps.get(name, {}).get("metrics", {}) for name in names)
    counts = carved.get("interior-points"), solid.get("uncovered-points")
    outcome, cause = cell["outcome"], cell.get("cause")
    trial.update(
        verdict=verdict.judge(outcome, cause, metrics, genus, trial["bound"]),
        # The alpha-solid may have been measured although a later step failed.
        before=verdict.judge("ok" if before else outcome, cause, before, genus, trial["bound"]),
        inside_before=int(solid["interior-points"]) if "interior-points" in solid else None,
        error=cell.get("error", "").partition("\n")[0],  # the other lines contain paths of this run
        inside=None if None in counts else int(sum(counts)),
        warned=any(steps.get(name, {}).get(key) for key in ("warnings", "doubts")
                   for name in ("delaunay", "alpha-solid", "sculpt")),
        hausdorff=metrics.get("hausdorff"),
        mean=metrics.get("mean"),
        closed=metrics.get("closed"),
        components=metrics.get("components"),
        genus=metrics.get("genus"),
    )


def run(shape, options, folder):
    """All trials of a shape. A scan that is not in the report counts as crashed."""
    truth = folder / "truth.mesh.ply"
    write_ply(truth, shape.vertices, shape.triangles)
    trials = scans(shape, options.seeds, folder)
    cores = len(os.sched_getaffinity(0))
    report = scanmill.run(options.program, options.workflow, trials, folder / "out", options.limit, threads=1,
                          jobs=cores, inputs={"truth": truth})
    for cell in report["cells"]:
        fill_in(trials[cell["scan"]], report, cell, shape.genus)
    for trial in trials.values():
        if "verdict" not in trial:
            trial.update(verdict="crashed", before="crashed", error="this scan is not in the report",
                         warned=False, inside=None, inside_before=None, mean=None, hausdorff=None)
    return list(trials.values())


def main():
    options = arguments()
    load = machine.Load()
    described, trials = [], []
    try:
        for shape in surfaces(options.data):
            with tempfile.TemporaryDirectory() as folder:
                trials += run(shape, options, pathlib.Path(folder))
            described.append({"name": shape.name, "what": shape.what, "genus": shape.genus,
                              "triangles": len(shape.triangles)})
    except scanmill.Broken as broken:
        sys.exit(f"error: {broken}")
    results = {**page.described("make bench-robustness"), "seeds": options.seeds, "points": POINTS_WITH_NOISE,
               "load": load.described(), "shapes": described, "trials": trials}
    lines = summary.lines(results)
    print("\n".join(lines))
    page.write(options.into, "results", results, lines)
    crashed = [trial for trial in trials if trial["verdict"] == "crashed"]
    for trial in crashed:
        print(f"error: {trial['shape']}, {trial['axis']} {trial['level']}, seed {trial['seed']}: {trial['error']}",
              file=sys.stderr)
    return 1 if crashed else 0


if __name__ == "__main__":
    sys.exit(main())
