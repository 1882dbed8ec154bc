#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""bernardini_table_1.py PROGRAM: compares Table 1 of Bernardini et al. 1997 with our results on similar objects.

Runs the workflow over all objects, ROUNDS times with one thread and with all threads, without a cache. Every number
comes from the program's JSON: the metrics and seconds of the steps, and the facts of the written mesh. Writes
bernardini-table-1.md and .json. The exit code is 1 if a run failed or a fetched file is missing.
"""
import pathlib
import sys

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

import table_1_page  # noqa: E402
from paper_table_1 import STAND_INS  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import paper, scanmill  # noqa: E402

ROOT = BENCH.parent
FILTERS = ("delaunay", "alpha-solid", "sculpt")


def arguments():
    return options_of.of_a_paper("Compares the paper's Table 1 with our results.",
                                 ROOT / "workflows" / "bernardini-1997.yaml").parse_args()


def begun(one, options):
    """The entry of an object before the run."""
    path = (options.data if one.fetched else options.more_data) / one.file
    entry = {"paper": one.paper, "file": one.file, "what": one.what, "failure": "", "skipped": ""}
    if not path.exists() and one.fetched:
        entry["failure"] = f"{one.file} is not there; `make data` fetches it"
    elif not path.exists():
        entry["skipped"] = f"{one.file} is not there, and `make data` does not fetch it"
    return entry, path


def judged(report, cell):
    """The result for one object from the report: counts, topology, and the total seconds of the three filters."""
    if cell["outcome"] not in ("ok", "doubtful"):
        return {"failure": cell.get("error", cell["outcome"])}
    steps = scanmill.steps(report, cell)
    missing = [name for name in FILTERS if name not in steps]
    if missing:
        raise scanmill.Broken(f"the workflow has no step {' and no '.join(missing)}")
    tets, solid, sculpted = (steps[name]["metrics"] for name in FILTERS)
    facts = scanmill.mesh(cell)["properties"]
    return {
        "points": int(steps["read"]["properties"]["points"]),
        "duplicates": int(tets["duplicates"]),
        "alpha": solid["alpha"],
        "tetrahedra": int(solid["cells"]),
        "inside_before": int(solid["interior-points"]),
        "uncovered": int(solid["uncovered-points"]),
        "removed": int(sculpted["removed"]),
        "exposing": int(sculpted["removed-exposing"]),
        "inside": int(sculpted["interior-points"]),
        "triangles": int(facts["triangles"]),
        "closed": facts["closed"],
        "components": int(facts["components"]),
        "genus": int(facts["genus"]) if "genus" in facts else None,
        "seconds": sum(steps[name]["seconds"] for name in FILTERS),
    }


def beside_its_model(options, path, mesh):
    """The spacing of the scan; if the scan is a mesh, also its topology and the distance of the result from it."""
    info = scanmill.info(options.program, path)
    found = {"spacing": info["spacing"], "model": None}
    if info["kind"] == "mesh":
        distances = scanmill.measure(options.program, mesh, path, options.limit,
                                     ["self-intersections=false", "same-frame=true"])
        found["model"] = {"closed": info["closed"], "genus": info.get("genus"), "components": info["components"],
                          "largest_distance": distances["hausdorff"] / info["diagonal"],
                          "mean_distance": distances["mean"] / info["diagonal"]}
    return found


def run(options, folder):
    """The results: entries named "objects", in the order of STAND_INS."""
    pairs = [begun(one, options) for one in STAND_INS]
    there = {str(path): (entry, path) for entry, path in pairs if not entry["failure"] and not entry["skipped"]}
    for number in range(options.rounds):
        for threads in ("1", "all"):
            into = folder / f"{threads}-{number}"
            report = scanmill.run(options.program, options.workflow, there, into, options.limit,
                                  threads=1 if threads == "1" else 0, until="surface")
            for cell in report["cells"]:
                entry, path = there[cell["scan"]]
                paper.take(entry, judged(report, cell), threads)
                if not entry["failure"] and "spacing" not in entry:
                    entry.update(beside_its_model(options, path, scanmill.mesh(cell)["file"]))
    return {"objects": [entry for entry, _ in pairs]}


def main():
    return paper.write("bernardini-table-1", arguments(), run, table_1_page.lines, tried="objects")


if __name__ == "__main__":
    sys.exit(main())
