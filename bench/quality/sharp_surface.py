#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""sharp_surface.py PROGRAM: makes smooth surfaces with creases of virtual scans, and compares them with the models.

Mechanical models are scanned without noise and with two levels of noise, organic ones without noise. The workflow
bernardini-1997-raw makes a dense mesh, a light mesh and a smooth surface of each scan. Writes sharp-surface.md and
.json. The exit code is 1 if a case fails or misses a goal (see NOTES in sharp_surface_page.py).
"""
import json
import pathlib
import shutil
import sys

import numpy

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

import crease_judge  # noqa: E402
import dihedral_judge  # noqa: E402
from creases import creases_of  # noqa: E402
from harness import machine  # noqa: E402
from raw_scans import scanned  # noqa: E402
from sharp_surface_page import DEGREES, DISTANCE, MECHANICAL, ORGANIC, lines_of, misses  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import page, scanmill  # noqa: E402
from tables.ply import write_ply  # noqa: E402

#: Standard deviations, in percent of the diagonal.
NOISES = [0, 0.05, 0.1]
CASES = [*((name, noise) for name in MECHANICAL for noise in NOISES), *((name, 0) for name in ORGANIC)]
#: Distance of the rays, in percent of the diagonal.
RESOLUTION = 0.5
SAMPLES = 50_000
#: Runs of `a-patch` without points.
RUNS = 2
#: Distance from a crease at which its dihedral angle is measured, in median edges of the light mesh.
ASIDE = 1 / 8


def loaded(file):
    import trimesh

    mesh = trimesh.load(file, process=False)
    return numpy.asarray(mesh.vertices, float), numpy.asarray(mesh.faces)


def median_edge(vertices, triangles):
    edges = numpy.unique(numpy.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    return float(numpy.median(numpy.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)))


def words_of(cell):
    """The reason of a failed run, in one line; empty after a success."""
    if cell["outcome"] in ("ok", "doubtful"):
        return ""
    error = cell.get("error", cell["outcome"])
    return first_line(error["message"] if isinstance(error, dict) else error)


def first_line(text):
    """Further lines name files of the run."""
    return (str(text).splitlines() or [""])[0]


def text_of(failure, options):
    """The text of an exception, without the folder of the program."""
    words = "" if isinstance(failure, scanmill.Broken) else f"{type(failure).__name__}: "
    return words + first_line(failure).replace(str(options.program), options.program.name)


def declared_creases(program, mesh, folder, limit, runs=1, until=None):
    """The sharp edges that a mesh declares, as features, and the least processor time of `a-patch` on one thread."""
    seconds = []
    for _ in range(runs):
        report = scanmill.run(program, BENCH / "quality" / "sharp-surface.yaml", [mesh], folder, limit, threads=1,
                              until=until)
        cell = report["cells"][0]
        if reason := words_of(cell):
            raise scanmill.Broken(reason)
        seconds.append(scanmill.named(report, cell).get("surface", {}).get("cpu-seconds"))
    return scanmill.features(cell), min(seconds) if None not in seconds else None


def patch_facts(steps):
    """The metrics of `a-patch` with points."""
    metrics, light = steps["a-patch"]["metrics"], steps["light"]["properties"]
    counts = {name: int(metrics[name]) for name in ("straight-edges", "refined", "inverted", "sign-violations")}
    return {"loosened": metrics["pointed-vertices"] / light["points"], "c1-jump": metrics["c1-jump"], **counts,
            "microseconds": 1e6 * steps["a-patch"]["cpu-seconds"] / light["triangles"]}


def measured(program, mesh, model, share, limit):
    facts = scanmill.measure(program, mesh, model, limit, [f"samples={SAMPLES}", "same-frame=true"])
    return {"triangles": int(facts["triangles"]), "closed": bool(facts["closed"]), "pieces": int(facts["components"]),
            "cuts": int(facts["self-intersections"]), "rms": share * facts["rms-to-truth"]}


def judge(record, truth, files, steps, folder, options):
    """Adds to the record what can be measured on the files of a run."""
    program, limit, share = options.program, options.limit, 100 / truth["diagonal"]
    if "light" not in files:
        return
    light = steps["light"]["properties"]
    record["triangles"] = {"dense": steps["fill-holes"]["properties"]["triangles"], "light": light["triangles"]}
    record["light"] = measured(program, files["light"], truth["file"], share, limit)
    lines, _ = declared_creases(program, files["light"], folder, limit, until="creases")
    record["creases"] = {"edges": len(crease_judge.segments(lines)[0]),
                         **crease_judge.judged(lines, truth["creases"], DISTANCE / share)}
    if "smooth" not in files:
        return
    record["patches"] = patch_facts(steps)
    record["smooth"] = measured(program, files["smooth"], truth["file"], share, limit)
    if record["name"] in MECHANICAL:
        edge = median_edge(*loaded(files["light"]))
        lines, _ = declared_creases(program, files["smooth"], folder, limit, until="creases")
        angles = dihedral_judge.judged(dihedral_judge.Surface(*loaded(files["smooth"])), lines, truth["surface"],
                                       truth["creases"], edge, ASIDE * edge, DISTANCE / share, DEGREES)
        record["angles"] = {**angles, "length": angles["length"] / truth["diagonal"]}


def add_time(record, files, folder, options):
    """Adds the time of `a-patch` without points."""
    if "light" in files:
        try:
            _, seconds = declared_creases(options.program, files["light"], folder, options.limit, runs=RUNS)
        except scanmill.Broken as failure:
            raise scanmill.Broken(f"without points: {failure}") from None
        record["alone"] = {"microseconds": 1e6 * seconds / record["triangles"]["light"]}


def truth_of(name, work, options):
    """The model: its file, diagonal, creases and surface."""
    model = options.data / "meshes" / f"{name}.off"
    vertices, triangles = loaded(model)
    copy = work / f"{name}.ply"
    write_ply(copy, vertices, triangles)  # creases_of names its files after its scan
    creases = creases_of(options.program, copy, 0, work / f"{name}-creases", options.limit, until="lines")["lines"]
    return {"file": model, "diagonal": float(numpy.linalg.norm(vertices.max(axis=0) - vertices.min(axis=0))),
            "creases": creases, "surface": dihedral_judge.Surface(vertices, triangles) if name in MECHANICAL else None}


def record_of(name, noise, truth, work, options):
    """One scan, and the facts of all that is made of it. A failure is in `error`, beside the facts found before it."""
    record = {"name": name, "noise": noise}
    folder = work / f"{name}-{noise:g}"
    made = folder / "made"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        scan = folder / "scan.ply"
        points = scanned(options.program, truth["file"], noise, RESOLUTION, folder, options.limit)
        write_ply(scan, points)
        record["points"] = len(points)
        report = scanmill.run(options.program, options.workflows / "bernardini-1997-raw.yaml", [scan], made,
                              options.limit)
        cell = report["cells"][0]
        steps = scanmill.named(report, cell)
        record["run"] = {"outcome": cell["outcome"],
                         "seconds": sum(step.get("cpu-seconds", 0) for step in steps.values())}
        if reason := words_of(cell):
            record["error"] = reason
        files = {pathlib.Path(one["file"]).stem.rsplit("-", 1)[-1]: one["file"] for one in cell.get("outputs", [])
                 if one["outcome"] == "ok" and one["file"].endswith(".ply")}
        judge(record, truth, files, steps, made, options)
        add_time(record, files, made, options)
    except Exception as failure:  # whatever fails in one case, the others count
        record["error"] = "; ".join(filter(None, [record.get("error"), text_of(failure, options)]))
    if not options.keep:
        shutil.rmtree(made, ignore_errors=True)
    return record


def main():
    parser = options_of.of_a_table("Compares smooth surfaces with creases of virtual scans with the models.", None, 300,
                                   "quality")
    parser.add_argument("--models", help="names, separated by commas; the page is then written beside the scans")
    parser.add_argument("--noises", help="standard deviations in percent of the diagonal, likewise")
    parser.add_argument("--workflows", type=pathlib.Path, default=BENCH.parent / "workflows", help="their folder")
    parser.add_argument("--work", type=pathlib.Path, help="folder of the scans (default: build/peers/sharp-surface)")
    parser.add_argument("--keep", action="store_true", help="keep all meshes there, about 0.1 GB per case")
    options = parser.parse_args()
    work = options.work or options.program.resolve().parents[2] / "peers" / "sharp-surface"
    work.mkdir(parents=True, exist_ok=True)
    names = options.models.split(",") if options.models else [*MECHANICAL, *ORGANIC]
    noises = [float(noise) for noise in options.noises.split(",")] if options.noises else NOISES
    load = machine.Load()
    records, truths = [], {}
    for name, noise in CASES:
        if name not in names or noise not in noises:
            continue
        try:
            truths[name] = truths.get(name) or truth_of(name, work, options)
            records.append(record_of(name, noise, truths[name], work, options))
        except Exception as failure:  # the model cannot be read or has no creases
            records.append({"name": name, "noise": noise, "error": text_of(failure, options)})
        print(f"{name}, noise {noise:g} %: {'; '.join(misses(records[-1])) or 'reaches all goals'}", file=sys.stderr,
              flush=True)
    results = {**page.described("make bench-quality"), "load": load.described(), "records": records}
    lines = lines_of(results)
    print("\n".join(lines))
    page.write(work if options.models or options.noises else options.into, "sharp-surface", results, lines)
    return 1 if not records or any(misses(record) for record in records) else 0


if __name__ == "__main__":
    sys.exit(main())
