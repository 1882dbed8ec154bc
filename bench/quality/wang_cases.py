# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the workflow to features on the cases of section 4.4 of Wang 2006, or on similar scans."""
import math
import pathlib

import paper_wang as paper
from tables import scanmill
from tables.paper import take

WORKFLOWS = pathlib.Path(__file__).resolve().parents[2] / "workflows"
FILTERS = ("voxel-thin", "region-grow", "features")


def begun(case, file, what, bin_size, path, fetched=True):
    """The entry of a case before the run. `bin_size` is a length as in a workflow."""
    entry = {"case": case, "file": file, "what": what, "bin": bin_size, "failure": "", "skipped": ""}
    if path and not path.exists() and fetched:
        entry["failure"] = f"{file} is not there; `make data` fetches it"
    elif path and not path.exists():
        entry["skipped"] = f"{file} is not there, and `make data` does not fetch it"
    return entry


def round_holes(features):
    """The centre and the radii of every hole: mean along the loop, least and largest at a vertex."""
    holes = []
    for line in features["polylines"]:
        if line["type"] != "hole":
            continue
        points = line["points"]
        segments = list(zip(points, points[1:] + points[:1]))
        lengths = [math.dist(a, b) for a, b in segments]
        whole = math.fsum(lengths)
        middle = [math.fsum(length * (a[axis] + b[axis]) / 2 for length, (a, b) in zip(lengths, segments)) / whole
                  for axis in range(3)]
        radii = [math.dist(middle, point) for point in points]
        mean = math.fsum(length * (math.dist(middle, a) + math.dist(middle, b)) / 2
                         for length, (a, b) in zip(lengths, segments)) / whole
        holes.append({"middle": middle, "mean": mean, "least": min(radii), "largest": max(radii)})
    return sorted(holes, key=lambda hole: -hole["mean"])


def judged(report, cell):
    """The result of one run from the report: counts, topology, distances, and total seconds of the three filters."""
    if cell["outcome"] not in ("ok", "doubtful"):
        return {"failure": cell.get("error", cell["outcome"])}
    steps = scanmill.steps(report, cell)
    missing = [name for name in (*FILTERS, "measure") if name not in steps]
    if missing:
        raise scanmill.Broken(f"the workflow has no step {' and no '.join(missing)}")
    thin, grown, lines, mesh = (steps[name]["metrics"] for name in (*FILTERS, "measure"))
    first = steps["read"]["properties"] if "read" in steps else steps["virtual-scan"]["metrics"]
    return {
        "points": int(first["points"]),
        "bin_size": thin["bin-size"],
        "kept": int(thin["kept"]),
        "unused": int(grown["unused-points"]),
        "vertices": int(mesh["vertices"]),
        "triangles": int(mesh["triangles"]),
        "components": int(mesh["components"]),
        "euler": int(mesh["euler"]),
        "genus": int(mesh["genus"]) if "genus" in mesh else None,
        "boundary_edges": int(mesh["boundary-edges"]),
        "loops": int(mesh["boundary-loops"]),
        "manifold": mesh["nonmanifold-edges"] + mesh["nonmanifold-vertices"] + mesh["misoriented-edges"] == 0,
        "self_intersections": int(mesh["self-intersections"]),
        "holes": int(lines["holes"]),
        "boundaries": int(lines["boundaries"]),
        "creases": int(lines["creases"]),
        "deviation_p95": mesh["p95"],
        "deviation_max": mesh["max"],
        "beyond_borders": int(mesh["beyond-borders"]),
        "diagonal": mesh["diagonal"],
        "seconds": math.fsum(steps[name]["seconds"] for name in FILTERS),
    }


def its_model(options, path):
    """If the scan is a mesh, the topology of that mesh; otherwise None."""
    info = scanmill.info(options.program, path)
    if info["kind"] != "mesh":
        return None
    return {"loops": info["boundary-loops"], "genus": info.get("genus"), "components": info["components"]}


def cases_of(options, hyperboloid):
    """Entry, workflow and scan of every case. The scan is None if the workflow makes it."""
    whole = WORKFLOWS / "wang-2006.yaml"
    cases = [(begun("hyperboloid", "hyperboloid", "the thesis's own points, from its formula",
                    f"{paper.HYPERBOLOID.bin_size} u", hyperboloid), whole, hyperboloid),
             (begun("block", "block", "a virtual scan of a similar block; the thesis prints neither the positions of "
                    "the small holes nor whether its holes have floors", f"{paper.CASES['block'].bin_size} u", None),
              WORKFLOWS / "wang-2006-block.yaml", None)]
    for one in paper.STAND_INS:
        path = (options.data if one.fetched else options.more_data) / one.file
        share = f"{100 * paper.CASES[one.case].bin_share:.3f} %diag"
        cases.append((begun(one.case, one.file, one.what, share, path, one.fetched), whole, path))
    return cases


def run(options, hyperboloid, folder):
    """The entries, in this order: the hyperboloid, the block, STAND_INS."""
    cases = cases_of(options, hyperboloid)
    for number in range(options.rounds):
        for threads in ("1", "all"):
            for place, (entry, workflow, path) in enumerate(cases):
                if entry["failure"] or entry["skipped"]:
                    continue
                report = scanmill.run(options.program, workflow, [path] if path else [],
                                      folder / f"case-{place}-{threads}-{number}", options.limit,
                                      threads=1 if threads == "1" else 0, settings={"bin-size": entry["bin"]})
                take(entry, judged(report, report["cells"][0]), threads)
                if path and not entry["failure"] and "model" not in entry:
                    entry["model"] = its_model(options, path)
                if entry["case"] == "block" and not entry["failure"] and "radii" not in entry:
                    entry["radii"] = round_holes(scanmill.features(report["cells"][0]))
    return [entry for entry, _, _ in cases]
