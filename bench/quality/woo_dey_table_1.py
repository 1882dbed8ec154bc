#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""woo_dey_table_1.py PROGRAM: compares the reconstructions of Table 1 of Woo, Dey 2005 with ours.

The paper reconstructs an initial cloud and an updated one by tight cocone. For each of its clouds, one of our models is
scanned and thinned, and as many points as the paper has are drawn from the scan (woo-dey-cloud.yaml). delaunay and
tight-cocone make a mesh of them (woo-dey.yaml), ROUNDS times with one thread and with all threads, without a cache.
Every number comes from the program's JSON. Writes woo-dey-table-1.md and .json. The exit code is 1 if a run failed or a
model is missing.
"""
import pathlib
import random
import statistics
import sys
from dataclasses import dataclass

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

from tables import options as options_of  # noqa: E402
from tables import page, paper, scanmill  # noqa: E402

SEED = 2005
FILTERS = ("delaunay", "tight-cocone")


@dataclass(frozen=True)
class Cloud:
    """A cloud of the paper, and voxels that leave a few percent more points of our model's scan."""

    name: str
    stage: str
    points: int
    seconds: float  #: of the paper's reconstruction; 0: not printed
    bin_share: float  #: the voxels' edge in percent of the diagonal


@dataclass(frozen=True)
class Model:
    """The paper's object, and the file that stands in for it."""

    paper: str
    file: str
    what: str
    clouds: tuple


MODELS = [
    Model("test block", "meshes/anchor_dense.off", "a machine part with holes",
          (Cloud("test block", "initial", 5991, 0, 1.54), Cloud("test block", "updated", 17057, 44.86, 0.91))),
    Model("airbag", "meshes/fandisk_large.off", "a machine part with curved faces and sharp edges",
          (Cloud("airbag", "initial", 28650, 0, 0.635), Cloud("airbag", "updated", 60959, 337.32, 0.436))),
    Model("golf club", "meshes/handle.off", "a closed part without holes",
          (Cloud("golf club", "initial", 49380, 0, 0.544), Cloud("golf club", "updated", 53570, 388.8, 0.522))),
    Model("joystick", "meshes/hand.off", "a hand, free-form",
          (Cloud("joystick", "initial", 37122, 0, 0.624), Cloud("joystick I", "updated", 45893, 370.8, 0.56),
           Cloud("joystick II", "updated", 65956, 367.12, 0.455))),
]

HEADER = ["object", "cloud", "points n", "tetrahedra", "triangles", "triangles − (2n − 4)", "unused", "poor", "closed",
          "components", "genus (model)", "invented", "farthest", "delaunay", "tight-cocone", "time",
          "per 10,000 points"]

NOTES = """\
Lines in bold are printed in the paper (Visual C++ and CGAL, Pentium IV of 1.6 GHz, 512 MB). **None of our clouds is the
paper's data**, which is not published. The lines below them are ours: a model is scanned from 30 views, 0.2 % of its
diagonal between rays, and thinned with voxels that leave a few percent more points than the paper has; the paper's
number of them is drawn at random with the seed {seed}. The objects are of another kind; only the numbers of points are
equal, so compare times, not shapes. An updated cloud is drawn from the same model as the initial one, and contains no
modification.

The paper prints the time of a reconstruction by tight cocone for the updated clouds only. Table 1 has three more
columns of times, for boundary detection, for overlapping facets, and for segmentation and selection. They belong to the
update of the initial model and are not compared here.

A closed surface of genus 0 through all n points has 2n − 4 triangles; every unused point removes 2, every handle adds
4, and every connected component beyond the first removes 4. *poor* counts points around which cocone's surface is not a
closed fan. *invented* is the share of the area that is not in cocone's surface. The genus is that of our mesh and, in
brackets, of the model. *farthest* is the Hausdorff distance between the mesh and the model, in percent of the diagonal.
Times are those of the filters alone, with one thread and, after the slash, with all threads (median of {rounds}
rounds); *time* is the sum of the two filters. The last column is the time with one thread."""


def arguments():
    return options_of.of_a_paper("Compares the reconstructions of the paper's Table 1 with ours.",
                                 BENCH / "quality" / "woo-dey.yaml").parse_args()


def drawn(lines, count):
    """`count` of the lines with their coordinates alone, in their order. The choice depends on SEED only."""
    chosen = sorted(random.Random(SEED).sample(range(len(lines)), count))
    return [" ".join(lines[row].split()[:3]) for row in chosen]


def write_cloud(options, model, cloud, folder):
    """Writes a cloud of the paper's size. Returns its file."""
    into = folder / f"{cloud.name} {cloud.stage}"
    scanmill.run(options.program, BENCH / "quality" / "woo-dey-cloud.yaml", [model], into, options.limit,
                 settings={"bin-size": f"{cloud.bin_share} %diag"})
    lines = (into / f"{model.stem}.xyz").read_text().splitlines()
    if len(lines) < cloud.points:
        raise scanmill.Broken(f"{model.name}: voxels of {cloud.bin_share} %diag leave {len(lines)} points, fewer than "
                              f"the {cloud.points} of the paper's cloud")
    file = into / "cloud.xyz"
    file.write_text("\n".join(drawn(lines, cloud.points)) + "\n")
    return file


def judged(report, cell):
    """The result for one cloud, with the seconds of the two filters."""
    if cell["outcome"] not in ("ok", "doubtful"):
        return {"failure": cell.get("error", cell["outcome"])}
    steps = scanmill.steps(report, cell)
    missing = [name for name in (*FILTERS, "measure") if name not in steps]
    if missing:
        raise scanmill.Broken(f"the workflow has no step {' and no '.join(missing)}")
    tets, surface, measured = (steps[name]["metrics"] for name in (*FILTERS, "measure"))
    facts = scanmill.mesh(cell)["properties"]
    return {
        "points": int(steps["read"]["properties"]["points"]),
        "duplicates": int(tets["duplicates"]),
        "tetrahedra": int(tets["cells"]),
        "triangles": int(facts["triangles"]),
        "unused": int(surface["unused-points"]),
        "poor": int(surface["poor"]),
        "closed": facts["closed"],
        "components": int(facts["components"]),
        "genus": int(facts["genus"]) if "genus" in facts else None,
        "invented": surface["invented-area"] / measured["area"],
        "farthest": measured["hausdorff"] / measured["diagonal"],
        "doubtful": cell["outcome"] == "doubtful",
        "seconds": {name: steps[name]["seconds"] for name in FILTERS},
    }


def run(options, folder):
    """The results: entries named "clouds", in the order of MODELS."""
    entries, there = [], []
    for model in MODELS:
        path = options.data / model.file
        for cloud in model.clouds:
            entry = {"paper": cloud.name, "stage": cloud.stage, "file": model.file, "what": model.what, "seed": SEED,
                     "bin_size": f"{cloud.bin_share} %diag", "failure": ""}
            entries.append(entry)
            if not path.exists():
                entry["failure"] = f"{model.file} is not there; `make data` fetches it"
                continue
            entry["model_genus"] = scanmill.info(options.program, path).get("genus")
            there.append((entry, path, write_cloud(options, path, cloud, folder)))
    for number in range(options.rounds):
        for threads in ("1", "all"):
            for entry, path, file in there:
                report = scanmill.run(options.program, options.workflow, [file], file.parent / f"{threads}-{number}",
                                      options.limit, threads=1 if threads == "1" else 0, inputs={"model": path})
                paper.take(entry, judged(report, report["cells"][0]), threads)
    return {"clouds": entries}


def middle(entry, threads, filters=FILTERS):
    """The median of the sum of these filters' seconds."""
    return statistics.median(sum(seconds[name] for name in filters) for seconds in entry["seconds"][threads])


def per_10_000(seconds, points):
    return 10_000 * seconds / points


def printed_line(cloud):
    cells = [f"**{cloud.name}**", cloud.stage, f"{cloud.points:,}"]
    cells += [""] * (len(HEADER) - len(cells))
    if cloud.seconds:
        cells[-2:] = [f"{cloud.seconds:.2f} s", f"{per_10_000(cloud.seconds, cloud.points):.1f} s"]
    return cells


def our_line(entry):
    name = f"{entry['file'].removeprefix('meshes/')}, {entry['what']}"
    if entry["failure"]:
        return [name, entry["stage"], "failed", *[""] * (len(HEADER) - 3)]
    bound = 2 * entry["points"] - 4
    times = [f"{middle(entry, '1', filters):.2f} / {middle(entry, 'all', filters):.2f} s"
             for filters in (*((one,) for one in FILTERS), FILTERS)]
    return [name, entry["stage"], f"{entry['points']:,}", f"{entry['tetrahedra']:,}", f"{entry['triangles']:,}",
            f"{entry['triangles'] - bound:+,}", f"{entry['unused']:,}", f"{entry['poor']:,}",
            "yes" if entry["closed"] else "no", str(entry["components"]), f"{entry['genus']} ({entry['model_genus']})",
            f"{100 * entry['invented']:.2g} %", f"{100 * entry['farthest']:.2g} %", *times,
            f"{per_10_000(middle(entry, '1'), entry['points']):.2f} s"]


def conclusion(entries):
    """A summary of all entries."""
    done = [entry for entry in entries if not entry["failure"]]
    if not done:
        return "Nothing ran."

    def named(entry):
        return f"{entry['paper']} ({entry['stage']}"

    used = sum(entry["unused"] == 0 for entry in done)
    genus = [entry for entry in done if entry["genus"] != entry["model_genus"]]
    text = f"In {used} of {len(done)} clouds every point is used. "
    text += "All meshes have their model's genus" if not genus else "Genus that differs from the model's: " + ", ".join(
        f"{named(entry)}, {entry['genus']} instead of {entry['model_genus']})" for entry in genus)
    doubtful = [f"{named(entry)})" for entry in done if entry["doubtful"]]
    text += f". Doubtful: {', '.join(doubtful)}." if doubtful else "."
    printed = {(cloud.name, cloud.stage): cloud.seconds for model in MODELS for cloud in model.clouds}
    ratios = [printed[entry["paper"], entry["stage"]] / middle(entry, "1") for entry in done
              if printed[entry["paper"], entry["stage"]]]
    if ratios:
        text += f" At equal numbers of points, one core takes 1/{min(ratios):,.0f} to 1/{max(ratios):,.0f} of the "
        text += "paper's times."
    return text


def lines(results):
    entries = {(entry["paper"], entry["stage"]): entry for entry in results["clouds"]}
    rows = []
    for model in MODELS:
        for cloud in model.clouds:
            rows += [printed_line(cloud), our_line(entries[cloud.name, cloud.stage])]
    text = page.heading("The reconstructions of Table 1 of Woo and Dey 2005, compared with Scanmill", results,
                        "woo-dey-table-1.json")
    text += [NOTES.format(rounds=results["rounds"], seed=SEED), "", *page.table(HEADER, rows), ""]
    return text + [conclusion(results["clouds"]), "", page.other_load(results["load"])]


def main():
    return paper.write("woo-dey-table-1", arguments(), run, lines, tried="clouds")


if __name__ == "__main__":
    sys.exit(main())
