# SPDX-License-Identifier: GPL-3.0-or-later
"""A real update for woo_dey_updates.py: one raw view of the bunny is left out of the model and added later."""
from __future__ import annotations

import pathlib
import sys
from argparse import Namespace

import numpy

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "quality")]

import update_models  # noqa: E402
from tables import page, scanmill  # noqa: E402
from tables.ply import write_ply  # noqa: E402

WORKFLOW = BENCH / "quality" / "mesh-update.yaml"
LEFT_OUT = "chin"  #: the only view that shows the underside
BIN_SIZE = 0.0015  #: 0.6 % of the bunny's diagonal; all scans get voxels of this size
#: The middle of the points of this view that are far from all others, and a radius that adds a ring around them.
CENTRE, RADIUS = (-0.0183, 0.0361, 0.0113), 0.058
CLOUDS = {"whole": "the whole view", "part": "its points around the underside"}
COUNTS = ("initial", "resampled", "added", "discarded", "kept", "unused-points")
REASON = 200  #: characters of a reason on the page

NOTES = f"""\
## A view that was left out

The model is tight-cocone's mesh of nine raw views of the Stanford bunny, the cloud is the tenth (`{LEFT_OUT}`), the
only one that shows the underside. The views are merged by their published poses, freed of outliers, smoothed and
thinned by the same steps ([posed-views.yaml](posed-views.yaml)), without further registration. tight-cocone closes
the underside of the nine views with large triangles; the tenth view replaces them. It is added as a whole, and as the
part within {RADIUS:g} u of the middle of the underside.

*mean* and *largest* are distances of Stanford's merged points from the mesh, in percent of the diagonal, *recall* is
the share of them nearer than 0.5 % of it. The underside has two real holes, and no view shows their walls: the new
surface there is a guess, and the genus may depend on it. *deviation* is the largest distance of a new point from the
model, in percent of the diagonal."""


def points_of(options: Namespace, views: list[pathlib.Path], folder: pathlib.Path) -> numpy.ndarray:
    poses = views[0].parent / "bun.conf"
    scanmill.run(options.program, BENCH / "quality" / "posed-views.yaml", views, folder, options.limit,
                 settings={"poses": poses, "bin-size": f"{BIN_SIZE} u"})
    return update_models.load_points(folder / "points.xyz")


def judged(options: Namespace, mesh: pathlib.Path, truth: pathlib.Path) -> dict:
    found = scanmill.measure(options.program, mesh, truth, options.limit, ["borders=exclude"])
    share = 100 / found["diagonal"]
    return {"mean": share * found["mean-from-truth"], "largest": share * found["max-from-truth"],
            "recall": found["recall"], "genus": int(found["genus"]) if "genus" in found else None, "share": share}


def update(options: Namespace, model: pathlib.Path, cloud: pathlib.Path, rebuild: str, truth: pathlib.Path,
           folder: pathlib.Path) -> dict:
    report = scanmill.run(options.program, WORKFLOW, [model], folder, options.limit, threads=1,
                          inputs={"clouds": cloud}, settings={"rebuild": rebuild})
    cell = report["cells"][0]
    if cell["outcome"] not in ("ok", "doubtful"):
        reason = str(cell.get("error", "")).partition("\n")[0]
        return {"outcome": cell.get("cause", cell["outcome"]), "reasons": [reason]}
    step = scanmill.steps(report, cell)["mesh-update"]
    metrics = step["metrics"]
    facts = judged(options, pathlib.Path(scanmill.mesh(cell)["file"]), truth)
    return {"outcome": "updated" if cell["outcome"] == "ok" else "updated, doubtful",
            "reasons": [doubt.removeprefix("mesh-update: ") for doubt in cell.get("doubts", [])],
            **{name: int(metrics[name]) for name in COUNTS}, **facts,
            "deviation": facts["share"] * max(value for name, value in metrics.items()
                                              if name.partition("@")[0] == "deviation"),
            "seconds": step["seconds"]}


def record(options: Namespace, folder: pathlib.Path) -> dict:
    """The results, empty without the raw views."""
    raw = options.more_data / "1-bunny" / "raw"
    views = sorted(raw.glob("*.ply"))
    if not views:
        return {}
    import trimesh

    merged = trimesh.load(options.more_data / "1-bunny" / "bun_zipper.ply", process=False)
    folder.mkdir(parents=True)
    truth = folder / "truth.ply"
    write_ply(truth, numpy.asarray(merged.vertices)[numpy.unique(merged.faces)])
    write_ply(folder / "initial.ply", points_of(options, [view for view in views if view.stem != LEFT_OUT],
                                                folder / "nine"))
    model = update_models.surface_of(options.program, folder / "initial.ply", folder / "model", options.limit)
    view = points_of(options, [raw / f"{LEFT_OUT}.ply"], folder / "tenth")
    near = numpy.linalg.norm(view - numpy.array(CENTRE), axis=1) < RADIUS
    found = []
    for name, points in (("whole", view), ("part", view[near])):
        write_ply(folder / f"{name}.ply", points)
        found += [{"cloud": name, "rebuild": rebuild,
                   **update(options, model, folder / f"{name}.ply", rebuild, truth, folder / f"{name}-{rebuild}")}
                  for rebuild in ("whole", "local")]
    return {"model": judged(options, model, truth), "updates": found}


HEADER = ["cloud", "rebuild", "outcome", "initial", "cloud", "resampled", "discarded", "updated", "unused", "genus",
          "deviation", "mean", "largest", "recall", "seconds, one thread"]


def measured(facts: dict) -> list[str]:
    return [f"{facts['mean']:.4f}", f"{facts['largest']:.2f}", f"{facts['recall']:.4f}"]


def row_of(update: dict) -> list[str]:
    first = [CLOUDS[update["cloud"]], f"`{update['rebuild']}`", update["outcome"]]
    if "mean" not in update:
        return [*first, *[""] * (len(HEADER) - len(first))]
    return [*first, f"{update['initial']:,}", f"{update['added']:,}", f"{update['resampled']:,}",
            f"{update['discarded']:,}", f"{update['kept'] + update['added']:,}", f"{update['unused-points']:,}",
            "" if update["genus"] is None else str(update["genus"]), f"{update['deviation']:.2f}", *measured(update),
            f"{update['seconds']:.2f}"]


def lines(results: dict) -> list[str]:
    if not results:
        return ["The real case, a view of the bunny that was left out, is skipped: its files are not in the folder of "
                "`--more-data`."]
    model = results["model"]
    before = ["the model", "", "", *[""] * 6, "" if model["genus"] is None else str(model["genus"]), "",
              *measured(model), ""]
    text = [NOTES, "", *page.table(HEADER, [before, *(row_of(one) for one in results["updates"])]), ""]
    for one in results["updates"]:
        for reason in one["reasons"]:
            text += [f"{CLOUDS[one['cloud']].capitalize()}, `{one['rebuild']}`: {reason[:REASON]}.", ""]
    return text[:-1]
