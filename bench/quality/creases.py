#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""creases.py PROGRAM: compares the creases of noisy meshes and of noisy scans with those of the clean models.

True creases are those of `features` at its defaults on the model. *mesh* is the model whose vertices got noise, *scan*
20 virtual views with noise, thinned by `voxel-thin` and grown by `region-grow`. Writes creases.md and .json. The exit
code is 1 if a program fails or a case of GOALS misses them.
"""
import json
import pathlib
import sys

import numpy

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

from crease_judge import judged  # noqa: E402
from harness import machine  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import page, scanmill  # noqa: E402
from tables.ply import write_ply  # noqa: E402

MODELS = ["fandisk_large", "anchor_dense", "couplingdown", "rotor_small", "hand"]
#: Standard deviations, in percent of the diagonal.
NOISES = [0, 0.02, 0.05]
#: Distance up to which a line counts as found or true, in percent of the diagonal.
DISTANCE = 0.5
#: Models that have to reach LEAST_FOUND and MOST_FALSE with the noise GOAL.
GOALS = ["fandisk_large", "anchor_dense"]
GOAL = 0.05
LEAST_FOUND = 0.95
MOST_FALSE = 0.1

NOTES = f"""\
True creases are those of `features` on the clean model. *mesh* is the model with noise added to its vertices, *grown* the
creases that `region-grow` reports for 20 virtual views with noise along the rays, thinned by `voxel-thin` to
0.5 %diag, and *again* those of `features` on the grown mesh. *noise* is the standard deviation in percent of the
diagonal. *found* is the share of the true length that is within {DISTANCE} %diag of a crease found, *false* the share of
the length found that is farther than that from every true crease. On {" and ".join(GOALS)}, with a noise of
{GOAL:g} %diag, at least {100 * LEAST_FOUND:g} % must be found and at most {100 * MOST_FALSE:g} % false. Clean grown meshes can have gaps where
triangles bridge a crease and each of two edges has less than the sharp angle; with noise such triangles join one side."""


def noisy(model, noise, file):
    """Writes the model with normally distributed noise in each coordinate; returns its diagonal."""
    import trimesh

    mesh = trimesh.load(model, process=False)
    positions = numpy.asarray(mesh.vertices, float)
    diagonal = float(numpy.linalg.norm(positions.max(axis=0) - positions.min(axis=0)))
    random = numpy.random.default_rng(1)
    if noise:
        positions = positions + random.normal(0, noise / 100 * diagonal, positions.shape)
    write_ply(file, positions, numpy.asarray(mesh.faces))
    return diagonal


def creases_of(program, file, noise, folder, limit, until=None):
    """Documents of the kind features by the last word of their file's name."""
    report = scanmill.run(program, BENCH / "quality" / "creases.yaml", [file], folder, limit,
                          settings={"noise": f"{noise} %diag"}, until=until)
    cell = report["cells"][0]
    if cell["outcome"] not in ("ok", "doubtful"):
        raise scanmill.Broken(cell.get("error", cell["outcome"]))
    return {pathlib.Path(one["file"]).stem.rsplit("-", 1)[-1]: json.loads(pathlib.Path(one["file"]).read_text())
            for one in cell["outputs"] if one["file"].endswith(".json")}


def record_of(name, options):
    model = options.data / f"{name}.off"
    work = options.program.resolve().parents[2] / "peers" / "creases" / name
    work.mkdir(parents=True, exist_ok=True)
    rows, true, distance = [], None, None
    for noise in NOISES:
        file = work / f"{name}-{noise:g}.ply"
        diagonal = noisy(model, noise, file)
        distance = DISTANCE / 100 * diagonal
        mesh = creases_of(options.program, file, 0, work / f"mesh-{noise:g}", options.limit, until="lines")["lines"]
        true = true or mesh
        scan = creases_of(options.program, work / f"{name}-0.ply", noise, work / f"scan-{noise:g}", options.limit)
        rows += [{"of": of, "noise": noise, **judged(lines, true, distance)}
                 for of, lines in [("mesh", mesh), ("grown", scan["grown"]), ("again", scan["again"])]]
    return {"name": name, "diagonal": diagonal, "lines": rows}


def share_text(value):
    return "" if value is None else f"{100 * value:.1f} %"


def lines_of(results):
    lines = [*page.heading("Creases of noisy meshes and scans", results, "creases.json"), NOTES, ""]
    lines += page.table(["model", "lines of", "noise", "creases", "length, in diagonals", "found", "false"],
                        [[record["name"], row["of"], f"{row['noise']:g}", f"{row['creases']:,}",
                          f"{row['length'] / record['diagonal']:.2f}", share_text(row["found"]),
                          share_text(row["false"])]
                         for record in results["models"] for row in record["lines"]])
    return [*lines, "", page.other_load(results["load"])]


def misses(record):
    """Sentences about the lines of a model of GOALS that are not as good as they must be."""
    if record["name"] not in GOALS:
        return []
    return [f"{record['name']}: of the creases of {row['of']} at {row['noise']:g} %diag {share_text(row['found'])} are "
            f"found, {share_text(row['false'])} are false"
            for row in record["lines"]
            if row["noise"] == GOAL and (row["found"] < LEAST_FOUND or row["false"] > MOST_FALSE)]


def main():
    parser = options_of.of_a_table("Compares creases of noisy meshes and scans with the true ones.", None, 600,
                                   "quality")
    parser.add_argument("--models", default=",".join(MODELS), help="names, separated by commas (default: %(default)s)")
    options = parser.parse_args()
    options.data = options.data / "meshes" if (options.data / "meshes").is_dir() else options.data
    load = machine.Load()
    records, failed = [], []
    for name in options.models.split(","):
        try:
            records.append(record_of(name, options))
            failed += misses(records[-1])
        except scanmill.Broken as failure:
            failed.append(f"{name}: {failure}")
    results = {**page.described("make bench-quality"), "load": load.described(), "models": records}
    lines = lines_of(results)
    print("\n".join(lines))
    page.write(options.into, "creases", results, lines)
    for failure in failed:
        print(f"error: {failure}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
