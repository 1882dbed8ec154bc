#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""surfaces.py PROGRAM: makes every kind of surface from the same points, and compares them with the models.

The points are the vertices of a model, or 20 virtual views of it with noise, thinned by `voxel-thin`. Writes
surfaces.md and .json. The exit code is 1 if the program fails; a filter that refuses points is a row of the table.
"""
import pathlib
import sys

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

from harness import machine  # noqa: E402
from raw_scans import judged, scanned, truth_of  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import page, scanmill  # noqa: E402
from tables.ply import write_ply  # noqa: E402

QUALITY = BENCH / "quality"
#: Models whose vertices are the points; the last one is open.
CLEAN = ["bunny00", "hand", "fandisk_large", "camel", "knot", "anchor_dense", "holes"]
#: Models that are scanned, with these standard deviations of the noise in percent of the diagonal.
SCANNED = ["bunny00", "anchor_dense"]
NOISES = [0.05, 0.2]
#: Distance of the rays and edge of the voxels, in percent of the diagonal.
RESOLUTION, VOXEL = 0.25, 0.5
#: The variants of surfaces.yaml, as they are named in the table.
NAMES = {"fill-holes": "region-grow, fill-holes", "big-balls": "tight-cocone, big-balls"}

NOTES = f"""\
The points of a *clean* input are the vertices of a model. The others are 20 views by `virtual-scan` with rays
{RESOLUTION} % of the diagonal apart and noise along the ray (standard deviation in percent of the diagonal), without
normals, thinned by `voxel-thin` with voxels of {VOXEL} %. All filters have their default parameters, except poisson
(`trim: 0 %`, after `normals`, before `repair` with `min-component: 1 %`), and get the same points
([surfaces.yaml](surfaces.yaml)).

*mean* and *largest* are distances between mesh and model, in both directions, in percent of the diagonal. *pieces*,
*loops* and *genus* are those of the mesh, with those of the model in brackets where they differ; a mesh that is not a
manifold has no genus. *used* is the share of the points that are vertices of the mesh; points that `fill-holes` adds
do not count. *cuts* counts pairs of intersecting triangles. *seconds* is the CPU time of all steps from the points to
the mesh."""


def surfaces_of(program, points, model, folder, limit):
    """Properties of the surfaces by variant; a variant without a mesh has no distances."""
    report = scanmill.run(program, QUALITY / "surfaces.yaml", [points], folder, limit)
    found = {}
    for cell in report["cells"]:
        steps = scanmill.steps(report, cell)
        made = [step for name, step in steps.items() if name != "read"]
        facts = {"outcome": cell["outcome"], "seconds": sum(step.get("cpu-seconds", 0) for step in made)}
        if cell["outcome"] == "failed":
            error = cell["error"]
            facts["reason"] = (error["message"] if isinstance(error, dict) else error).splitlines()[0]
        else:
            mesh = scanmill.mesh(cell)
            facts |= {"vertices": mesh["properties"]["points"], "closed": mesh["properties"]["closed"],
                      **judged(program, mesh["file"], model, limit)}
        found[cell["variant"]] = facts
    if "vertices" in found["fill-holes"]:  # it adds vertices
        found["fill-holes"]["vertices"] = found["region-grow"]["vertices"]
    return found


def record_of(name, noise, options, work):
    """One input, and the facts of all surfaces of it. `noise` is None for the vertices of the model."""
    model = options.data / "meshes" / f"{name}.off"
    folder = work / (f"{name}-clean" if noise is None else f"{name}-{noise:g}")
    folder.mkdir(parents=True, exist_ok=True)
    points = model
    if noise is not None:
        scan = folder / "scan.ply"
        write_ply(scan, scanned(options.program, model, noise, RESOLUTION, folder, options.limit))
        report = scanmill.run(options.program, QUALITY / "surfaces-thinned.yaml", [scan], folder, options.limit,
                              settings={"bin-size": f"{VOXEL} %diag"})
        points = pathlib.Path(report["cells"][0]["outputs"][0]["file"])
    count = scanmill.info(options.program, points)["points"]
    return {"name": name, "noise": noise, "points": count, "truth": truth_of(options.program, model, options.limit),
            "surfaces": surfaces_of(options.program, points, model, folder, options.limit)}


def beside_truth(facts, truth, name):
    """A number of the mesh, with that of the model in brackets if it differs."""
    value = "none" if facts[name] is None else facts[name]
    return value if facts[name] == truth[name] else f"{value} ({truth[name]})"


def row_of(record, name):
    facts = record["surfaces"][name]
    title, ends = NAMES.get(name, name), [f"{facts['seconds']:.1f}", facts["outcome"]]
    if "mean" not in facts:
        return [title, *[""] * 8, *ends]
    share = "" if name == "poisson" else f"{100 * facts['vertices'] / record['points']:.1f} %"
    return [title, "yes" if facts["closed"] else "no",
            *(beside_truth(facts, record["truth"], count) for count in ("pieces", "loops", "genus")),
            f"{facts['mean']:.3g}", f"{facts['largest']:.3g}", share, facts["intersections"], *ends]


def lines_of(results):
    lines = [*page.heading("Surfaces of the same points", results, "surfaces.json"), NOTES]
    for record in results["inputs"]:
        kind = "clean" if record["noise"] is None else f"noise {record['noise']:g} %"
        lines += ["", f"## {record['name']}, {kind}, {record['points']:,} points", ""]
        lines += page.table(["surface", "closed", "pieces", "loops", "genus", "mean", "largest", "used", "cuts",
                             "seconds", "outcome"],
                            [row_of(record, name) for name in record["surfaces"]])
        for name, facts in record["surfaces"].items():
            if "reason" in facts:
                lines += ["", f"{NAMES.get(name, name)}: {facts['reason']}"]
    return [*lines, "", page.other_load(results["load"])]


def main():
    parser = options_of.of_a_table("Compares the surfaces that our filters make of the same points.", None, 900,
                                   "quality")
    parser.add_argument("--models", help="names, separated by commas; only inputs of these")
    options = parser.parse_args()
    work = options.program.resolve().parents[2] / "peers" / "surfaces"
    chosen = options.models.split(",") if options.models else None
    load = machine.Load()
    records, failed = [], []
    for name, noise in [(name, None) for name in CLEAN] + [(name, noise) for name in SCANNED for noise in NOISES]:
        if chosen and name not in chosen:
            continue
        try:
            records.append(record_of(name, noise, options, work))
        except scanmill.Broken as failure:
            failed.append(f"{name}: {failure}")
    results = {**page.described("make bench-quality"), "load": load.described(), "inputs": records}
    lines = lines_of(results)
    print("\n".join(lines))
    page.write(options.into, "surfaces", results, lines)
    for failure in failed:
        print(f"error: {failure}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
