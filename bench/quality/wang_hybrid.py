#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""wang_hybrid.py PROGRAM: compares the mesh of a scan with the mesh of the scan and of touched edges (Wang 2006, chapter 6).

Every part goes the whole way: a virtual scan with noise and outliers, wang-2006-hybrid.yaml up to the DMIS program, a
simulated machine that runs this program on the true part and writes its results as DMIS (dmis_machine.py), and
scan-and-touches.yaml. Writes wang-hybrid.md and .json. The exit code is 1 if a program fails, or if less than LEAST_SHARE of an
exact part's planned edges is within the probe's error. Models that `make data` has not fetched are skipped.
"""
import json
import pathlib
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass

import numpy
from scipy.spatial import cKDTree

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

import crease_judge  # noqa: E402
import dmis_machine  # noqa: E402
import hybrid_parts as parts  # noqa: E402
import wang_hybrid_page  # noqa: E402
from harness import machine  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import page, scanmill  # noqa: E402
from tables.ply import read_vertices, write_ply  # noqa: E402

WORKFLOWS = BENCH.parent / "workflows"
QUALITY = BENCH / "quality"

RESOLUTION, BIN_SIZE = 0.25, 1.0
RADIUS, SCANNER_ERROR, SPACING = 2.0, 1.0, 2.0
SCANNER_NOISE, OUTLIERS, MACHINE_NOISE = 0.02, "0.5 %", 0.002
#: Eight views from above and from the sides, four from below.
VIEWS = "[" + ", ".join(f"{x}, {y}, {z}" for z in (-0.6, 0.4) for x, y in
                        ((1, 0.3), (-0.3, 1), (-1, -0.3), (0.3, -1))) + ", 0.1, 0.2, 1, -0.2, 0.1, -1]"
PLATE = (200.0, 120.0, 10.0)
#: The machine's frame: a turn about the plate's normal and a shift.
TURN = numpy.array([[0.8, -0.6, 0, 400], [0.6, 0.8, 0, 300], [0, 0, 1, 50], [0, 0, 0, 1.0]])
#: Parts whose edges are exact, straight or round; the others are models whose round edges are polygons, or blunt.
EXACT = ("block with five holes", "bicone")
#: Least share of the planned length where the crease is within the probe's error of the true edge.
LEAST_SHARE = 0.99
#: Creases farther than this from every true edge are false.
NEAR = BIN_SIZE
#: Distance of samples along edges.
STEP = 0.05
#: The default `chord-error` of probe-compensate, as a share of the distance of touches.
CHORD_ERROR = 0.005


def part_meshes(data):
    """Meshes by name, in mm, in the scanner's frame."""
    made = {"block with five holes": parts.block_with_holes(), "bicone": parts.bicone(),
            "flange": parts.flange()}
    for name in ("fandisk", "fandisk_large", "anchor_dense", "joint"):
        file = data / "meshes" / f"{name}.off"
        if file.exists():
            made[name] = parts.model(file)
    return made


def only_cell(report, what):
    cell = report["cells"][0]
    if cell["outcome"] not in ("ok", "doubtful"):
        error = cell.get("error", cell["outcome"])
        raise scanmill.Broken(f"{what}: {error['message'] if isinstance(error, dict) else error}")
    return cell


def scan_of(program, part, folder, limit):
    """Writes scans of the part and of the plate, and the plate's corners in the machine's frame."""
    write_ply(folder / "model.ply", part.vertices, part.faces)
    settings = {"views": VIEWS, "resolution": f"{RESOLUTION} mm", "noise": f"{SCANNER_NOISE} mm", "outliers": OUTLIERS}
    only_cell(scanmill.run(program, QUALITY / "wang-hybrid.yaml", [folder / "model.ply"], folder, limit, unit="mm",
                           settings=settings), "virtual scan")
    x, y = (numpy.arange(0.5 - size / 2, size / 2) for size in PLATE[:2])
    heights = numpy.random.default_rng(1).normal(PLATE[2] / 2, SCANNER_NOISE, (len(x), len(y)))
    write_ply(folder / "plate.ply", numpy.stack([*numpy.meshgrid(x, y, indexing="ij"), heights], axis=-1).reshape(-1, 3))
    corners = numpy.array([(x * PLATE[0] / 2, y * PLATE[1] / 2, PLATE[2] / 2, 1)
                           for x, y in ((-1, -1), (1, 1), (-1, 1), (1, -1))]) @ TURN.T
    (folder / "corners.csv").write_text("x,y,z\n" + "".join(f"{x},{y},{z}\n" for x, y, z, _ in corners))
    return folder / "part.ply"


@dataclass
class Planned:
    """Points along the lines of a plan between neighbouring touches that are made: at most two spacings apart."""

    points: numpy.ndarray
    #: The length that each point stands for.
    lengths: numpy.ndarray
    #: Whether both touches have two directions, which fix the edge.
    paired: numpy.ndarray


def planned_edges(plan, spacing):
    points, lengths, paired = [], [], []
    by_line, directions = {}, Counter()
    for touch in plan["touches"]:
        if touch["reason"] == "none":
            by_line.setdefault(touch["feature"], {})[touch["touch"]] = numpy.array(touch["point"])
            directions[touch["touch"]] += 1
    for places in by_line.values():
        order = sorted(places)
        for a, b in list(zip(order, order[1:])) + ([(order[-1], order[0])] if len(order) > 2 else []):
            length = float(numpy.linalg.norm(places[a] - places[b]))
            if length > 2 * spacing:
                continue
            count = max(1, round(length / STEP))
            shares = ((numpy.arange(count) + 0.5) / count)[:, None]
            points.append(places[a] * (1 - shares) + places[b] * shares)
            lengths.append(numpy.full(count, length / count))
            paired.append(numpy.full(count, directions[a] == directions[b] == 2))
    if not points:
        raise scanmill.Broken("the machine makes no two neighbouring touches")
    return Planned(numpy.concatenate(points), numpy.concatenate(lengths), numpy.concatenate(paired))


def weighted_quantile(values, weights, share):
    order = numpy.argsort(values, kind="stable")
    return float(values[order][numpy.searchsorted(numpy.cumsum(weights[order]), share * weights.sum())])


def nearest(points, lines):
    """Distance of each point from the nearest segment, the row of that segment, and the nearest point on it."""
    targets, _, rows = crease_judge.samples_of_segments(lines, STEP)
    if not len(targets):
        return numpy.full(len(points), numpy.inf), numpy.zeros(len(points), int), points
    # Among the eight nearest samples is one of the nearest segment, as samples are denser than the segments of the meshes.
    _, near = cKDTree(targets).query(points, k=min(8, len(targets)))
    near = rows[numpy.atleast_2d(near).reshape(len(points), -1)]
    starts, ends = lines[0][near], lines[1][near]
    along = ends - starts
    share = numpy.einsum("nki,nki->nk", points[:, None] - starts, along) / numpy.maximum(
        numpy.einsum("nki,nki->nk", along, along), 1e-30)
    feet = starts + numpy.clip(share, 0, 1)[..., None] * along
    distances = numpy.linalg.norm(points[:, None] - feet, axis=2)
    best = distances.argmin(axis=1)
    here = numpy.arange(len(points))
    return distances[here, best], near[here, best], feet[here, best]


def summary(distances, lengths):
    if not len(distances):
        return None
    return {"length": float(lengths.sum()), "mean": float((distances * lengths).sum() / lengths.sum()),
            "p95": weighted_quantile(distances, lengths, 0.95), "p99": weighted_quantile(distances, lengths, 0.99),
            "max": float(distances.max())}


def edge_deviation(features, planned, true, bound):
    """How far the creases of a mesh are from the true edges, in mm: distances from the points of the true edges that are
    nearest to the planned lines. `within`: the share of the length between pairs where they are at most `bound`."""
    feet = nearest(planned.points, true)[2]
    distances = nearest(feet, crease_judge.segments(features))[0]
    pairs, lengths = planned.paired, planned.lengths
    within = float(lengths[pairs & (distances <= bound)].sum() / lengths[pairs].sum()) if pairs.any() else None
    return {"pairs": summary(distances[pairs], lengths[pairs]), "singles": summary(distances[~pairs], lengths[~pairs]),
            "within": within}


def false_creases(features, true):
    """Length of creases farther than NEAR from every true edge, and of all creases, in mm."""
    points, lengths, _ = crease_judge.samples_of_segments(crease_judge.segments(features), STEP)
    if not len(points):
        return 0.0, 0.0
    return float(lengths[nearest(points, true)[0] > NEAR].sum()), float(lengths.sum())


def probe_error(edges):
    """Three standard deviations of a point that two touches fix (its 95 % quantile), and the allowed error of chords."""
    uncertainty = edges["uncertainty"][edges["uncertainty"] < SCANNER_ERROR / 2]
    return 3 * float(numpy.quantile(uncertainty, 0.95)) + CHORD_ERROR * SPACING if len(uncertainty) else 0.0


def moved(points):
    return points @ TURN[:3, :3].T + TURN[:3, 3]


def tried(program, name, part, folder, limit):
    scan = scan_of(program, part, folder, limit)
    first = ", ".join(f"{value} mm" for value in (-PLATE[0] / 2, -PLATE[1] / 2, PLATE[2] / 2))
    common = {"bin-size": f"{BIN_SIZE} mm", "radius": f"{RADIUS} mm", "scanner-error": f"{SCANNER_ERROR} mm"}
    report = scanmill.run(program, WORKFLOWS / "wang-2006-hybrid.yaml", [scan], folder / "plan", limit, unit="mm",
                          inputs={"plate": folder / "plate.ply", "corners": folder / "corners.csv"},
                          settings={**common, "spacing": f"{SPACING} mm", "first-corner": f"[{first}]", "features": "creases"})
    plan_steps = scanmill.named(report, only_cell(report, f"{name}: plan"))
    made = folder / "plan"
    plan = json.loads(next(made.glob("*-probes.json")).read_text())

    begun = time.monotonic()
    dmis = dmis_machine.read_program(next(made.glob("*-probes.dmi")))
    met, centres = dmis_machine.contacts(dmis, moved(part.vertices), part.faces)
    dmis_machine.write_results(folder / "results.dmi", dmis, met, centres, MACHINE_NOISE, seed=1)
    simulated = time.monotonic() - begun

    report = scanmill.run(program, WORKFLOWS / "scan-and-touches.yaml", [next(made.glob("*-scan.ply"))], folder / "both", limit,
                          unit="mm", settings={**common, "noise": f"{SCANNER_NOISE} mm"},
                          inputs={"touches": folder / "results.dmi", "plan": next(made.glob("*-probes.json"))})
    both_steps = scanmill.named(report, only_cell(report, f"{name}: scan and touches"))
    hybrid = next((folder / "both").glob("*-hybrid.ply"))
    # In the same frame and thus the same voxels: in others, the length of false creases differs by half.
    report = scanmill.run(program, QUALITY / "wang-hybrid-alone.yaml", [next(made.glob("*-scan.ply"))], folder / "alone", limit,
                          unit="mm", settings={"bin-size": common["bin-size"]})
    only_cell(report, f"{name}: scan alone")
    alone = next((folder / "alone").glob("*-alone.ply"))

    truth = folder / "truth.ply"
    write_ply(truth, moved(part.vertices), part.faces)
    true = tuple(moved(ends) for ends in parts.true_edges(part))
    planned = planned_edges(plan, SPACING)
    bound = probe_error(read_vertices(next((folder / "both").glob("*-edges.ply"))))
    hybrid_lines = json.loads(next((folder / "both").glob("*-hybrid-edges.json")).read_text())
    alone_lines = json.loads(next((folder / "alone").glob("*-alone-edges.json")).read_text())
    return {
        "plan_metrics": plan_steps["plan"]["metrics"], "grown": both_steps["mesh"]["metrics"],
        "compensated": both_steps["edges"]["metrics"], "missed": int((~met).sum()), "touched": int(met.sum()),
        "seconds_on_machine": dmis_machine.seconds(dmis), "seconds_simulated": simulated,
        "bound": bound, "true_length": float(numpy.linalg.norm(true[1] - true[0], axis=1).sum()),
        "hybrid": judged(program, hybrid, truth, hybrid_lines, planned, true, bound, limit),
        "alone": judged(program, alone, truth, alone_lines, planned, true, bound, limit),
    }


def judged(program, mesh, truth, lines, planned, true, bound, limit):
    false, creases = false_creases(lines, true)
    metrics = scanmill.measure(program, mesh, truth, limit, ["self-intersections=false"], truth_unit="mm")
    return {"edge": edge_deviation(lines, planned, true, bound), "false": false, "creases": creases,
            "mean": metrics["mean"], "p95": metrics["p95"], "vertices": metrics["vertices"]}


def main():
    parser = options_of.of_a_table("Compares a scan alone with scan and touches.", None, 900, "quality")
    parser.add_argument("--only", help="names of the parts, separated by commas")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the files of every part")
    options = parser.parse_args()
    load, cases = machine.Load(), []
    for name, part in part_meshes(options.data).items():
        if options.only and name not in options.only.split(","):
            continue
        with tempfile.TemporaryDirectory() as temporary:
            folder = options.keep / name.replace(" ", "-") if options.keep else pathlib.Path(temporary)
            folder.mkdir(parents=True, exist_ok=True)
            try:
                cases.append({"part": name, "failure": "", **tried(options.program, name, part, folder, options.limit)})
            except scanmill.Broken as broken:
                cases.append({"part": name, "failure": str(broken)})
        print(json.dumps(cases[-1], indent=1), file=sys.stderr)
    results = {**page.described("make bench-quality"), "load": load.described(),
               "settings": {"resolution": RESOLUTION, "noise": SCANNER_NOISE, "outliers": OUTLIERS, "bin_size": BIN_SIZE,
                            "spacing": SPACING, "radius": RADIUS, "machine_noise": MACHINE_NOISE, "near": NEAR},
               "cases": cases}
    lines = wang_hybrid_page.lines(results)
    print("\n".join(lines))
    page.write(options.into, "wang-hybrid", results, lines)
    failed = [f"{case['part']}: {case['failure']}" for case in cases if case["failure"]]
    failed += [f"{case['part']}: {100 * (case['hybrid']['edge']['within'] or 0):.1f} % of the paired length is within the probe's error"
               for case in cases if not case["failure"] and case["part"] in EXACT
               and (case["hybrid"]["edge"]["within"] or 0) < LEAST_SHARE]
    for each in failed:
        print(f"error: {each}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
