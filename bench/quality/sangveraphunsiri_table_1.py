#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""sangveraphunsiri_table_1.py PROGRAM: compares Table 1 of Sangveraphunsiri, Srirakulchai 2006 with our results.

For each of the paper's four kinds of surface one of our models is scanned, thinned to about as many points, and
triangulated by cluster-mesh, ROUNDS times with one thread and with all threads, without a cache. Every number comes
from the program's JSON. Writes sangveraphunsiri-table-1.md and .json. The exit code is 1 if a run failed or a model is
missing.
"""
import pathlib
import statistics
import sys
from dataclasses import dataclass

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

from tables import options as options_of  # noqa: E402
from tables import page, paper, scanmill  # noqa: E402


@dataclass(frozen=True)
class Printed:
    """A line of the paper's table."""

    surface: str
    max_edge: float
    points: int
    triangles: int


@dataclass(frozen=True)
class Model:
    """One of our models. The voxels leave about as many points as the paper's model has."""

    paper: str
    file: str
    bin_size: str
    what: str


PAPER = {
    "human face": Printed("open, with holes", 3.6, 5716, 11379),
    "pan handle": Printed("closed, with grooves", 2.8, 5271, 10538),
    "teeth": Printed("open, very complex", 1.6, 7886, 15487),
    "car seat": Printed("open, complex, sharp edges", 3.2, 9680, 19037),
}

MODELS = [
    Model("human face", "meshes/holes.off", "1.1 %diag", "an open part with 7 boundary loops"),
    Model("pan handle", "meshes/anchor_dense.off", "1.7 %diag", "a closed part with grooves and 4 handles"),
    Model("teeth", "meshes/armadillo.off", "1.15 %diag", "a closed, very complex surface; the paper's is open"),
    Model("car seat", "meshes/fandisk_large.off", "1.1 %diag", "a closed part with sharp edges; the paper's is open"),
]

HEADER = ["object", "surface", "max-edge", "points n", "unused", "triangles", "2n − 4", "difference", "closed",
          "components", "loops (model)", "boundary edges", "genus (model)", "intersections", "farthest", "time"]

NOTES = """\
Lines in bold are printed in the paper, whose data and times are not published. The lines below them are ours: a model
of the same kind is scanned from 30 views, 0.2 % of its diagonal between rays, and thinned with voxels that leave about
as many points. Compare the counts per point, not the totals. `max-edge` is ρ; ours is `auto`, 2.3 voxels. The paper
does not say whether its points are all used, nor how many boundary loops there are.

A closed surface of genus 0 through all n points has 2n − 4 triangles. Every boundary edge removes 1 triangle, every
boundary loop adds 2, every handle adds 4, and every connected component beyond the first removes 4. The paper's closed
model has exactly 2n − 4. *loops* and *genus* are those of our mesh and, in brackets, of the model; differences are
faults of our mesh.
*intersections* counts pairs of triangles that meet elsewhere than at common corners and edges. *farthest* is the
Hausdorff distance between the mesh and the model, in percent of the diagonal. The time is that of cluster-mesh alone,
with one thread and, after the slash, with all threads (median of {rounds} rounds)."""


def arguments():
    return options_of.of_a_paper("Compares the paper's Table 1 with our results.",
                                 BENCH / "quality" / "sangveraphunsiri.yaml").parse_args()


def judged(report, cell, model):
    """The result for one model, with the seconds of cluster-mesh."""
    if cell["outcome"] not in ("ok", "doubtful"):
        return {"failure": cell.get("error", cell["outcome"])}
    steps = scanmill.steps(report, cell)
    metrics, measured = steps["cluster-mesh"]["metrics"], steps["measure"]["metrics"]
    facts = scanmill.mesh(cell)["properties"]
    return {
        "max_edge": metrics["max-edge"],
        "points": int(steps["voxel-thin"]["metrics"]["kept"] - metrics["duplicates"]),
        "unused": int(metrics["unused-points"]),
        "triangles": int(facts["triangles"]),
        "closed": facts["closed"],
        "loops": int(metrics["loops"]),
        "boundary_edges": int(metrics["boundary-edges"]),
        "components": int(metrics["components"]),
        "genus": int(facts["genus"]),
        "intersections": int(measured["self-intersections"]),
        "farthest": measured["hausdorff"] / model["diagonal"],
        "doubtful": cell["outcome"] == "doubtful",
        "seconds": steps["cluster-mesh"]["seconds"],
    }


def expected_triangles(entry):
    """From used points, components, handles, boundary loops and boundary edges."""
    return (2 * (entry["points"] - entry["unused"]) - 4 * entry["components"] + 4 * entry["genus"]
            + 2 * entry["loops"] - entry["boundary_edges"])


def take(entry, judgement, threads):
    """Adds one run, whose counts must fit together."""
    paper.take(entry, judgement, threads)
    if not entry["failure"] and entry["triangles"] != expected_triangles(entry):
        raise scanmill.Broken(f"{entry['file']}: {entry['triangles']} triangles, but points, components, genus and "
                              f"boundaries give {expected_triangles(entry)}")


def run(options, folder):
    """The results: entries named "models", in the order of MODELS."""
    entries = []
    for one in MODELS:
        path = options.data / one.file
        entry = {"paper": one.paper, "file": one.file, "what": one.what, "bin_size": one.bin_size, "failure": ""}
        entries.append(entry)
        if not path.exists():
            entry["failure"] = f"{one.file} is not there; `make data` fetches it"
            continue
        model = scanmill.info(options.program, path)
        entry.update(model_genus=model.get("genus"), model_loops=model["boundary-loops"])
        for number in range(options.rounds):
            for threads in ("1", "all"):
                report = scanmill.run(options.program, options.workflow, [path], folder / f"{threads}-{number}",
                                      options.limit, threads=1 if threads == "1" else 0,
                                      settings={"bin-size": one.bin_size})
                for cell in report["cells"]:
                    take(entry, judged(report, cell, model), threads)
    return {"models": entries}


def printed_line(name):
    one = PAPER[name]
    bound = 2 * one.points - 4
    cells = [f"**{name}**", one.surface, f"{one.max_edge}", f"{one.points:,}", "", f"{one.triangles:,}", f"{bound:,}",
             f"{one.triangles - bound:+,}"]
    return cells + [""] * (len(HEADER) - len(cells))


def our_line(entry):
    name = entry["file"].removeprefix("meshes/")
    if entry["failure"]:
        return [name, entry["what"], "failed", *[""] * (len(HEADER) - 3)]
    bound = 2 * entry["points"] - 4
    middle = {threads: statistics.median(seconds) for threads, seconds in entry["seconds"].items()}
    return [name, entry["what"], f"{entry['max_edge']:.3g}", f"{entry['points']:,}", f"{entry['unused']:,}",
            f"{entry['triangles']:,}", f"{bound:,}", f"{entry['triangles'] - bound:+,}",
            "yes" if entry["closed"] else "no", str(entry["components"]), f"{entry['loops']} ({entry['model_loops']})",
            f"{entry['boundary_edges']:,}", f"{entry['genus']} ({entry['model_genus']})",
            f"{entry['intersections']:,}", f"{100 * entry['farthest']:.2g} %",
            f"{middle['1']:.3f} / {middle['all']:.3f} s"]


def conclusion(entries):
    """A summary of all entries."""
    done = [entry for entry in entries if not entry["failure"]]
    if not done:
        return "Nothing ran."
    used = sum(entry["unused"] == 0 for entry in done)
    loops = [entry for entry in done if entry["loops"] != entry["model_loops"]]
    genus = [entry for entry in done if entry["genus"] != entry["model_genus"]]
    text = f"In {used} of {len(done)} models every point is used. "
    text += "All have their model's loops" if not loops else "Loops that differ from the model's: " + ", ".join(
        f"{entry['file']} ({entry['loops']} instead of {entry['model_loops']})" for entry in loops)
    text += "; all have its genus" if not genus else "; genus that differs: " + ", ".join(
        f"{entry['file']} ({entry['genus']} instead of {entry['model_genus']})" for entry in genus)
    doubtful = [entry["file"] for entry in done if entry["doubtful"]]
    return text + (f". Doubtful: {', '.join(doubtful)}." if doubtful else ".")


def lines(results):
    entries = results["models"]
    rows = []
    for name in PAPER:
        rows.append(printed_line(name))
        rows += [our_line(entry) for entry in entries if entry["paper"] == name]
    text = page.heading("Table 1 of Sangveraphunsiri and Srirakulchai 2006, compared with Scanmill", results,
                        "sangveraphunsiri-table-1.json")
    text += [NOTES.format(rounds=results["rounds"]), "", *page.table(HEADER, rows), "", conclusion(entries)]
    return text + ["", page.other_load(results["load"])]


def main():
    return paper.write("sangveraphunsiri-table-1", arguments(), run, lines, tried="models")


if __name__ == "__main__":
    sys.exit(main())
