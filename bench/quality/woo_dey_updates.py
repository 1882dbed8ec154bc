#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""woo_dey_updates.py PROGRAM: compares the updates of Table 1 of Woo, Dey 2005 with ours.

The paper updates models by locally added clouds. For each of its examples a script makes a similar solid and a changed
one. Both are scanned by virtual-scan and thinned to the paper's numbers of points; tight-cocone makes the model, and
mesh-update adds the clouds, ROUNDS times with one thread and with all threads, without a cache. Every count and time
comes from the program's JSON. Writes woo-dey-updates.md and .json. The exit code is 1 if a run failed.
"""
from __future__ import annotations

import pathlib
import statistics
import sys
from argparse import Namespace
from collections.abc import Callable
from dataclasses import dataclass

import manifold3d
import numpy

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers"), str(BENCH / "quality")]

import update_cases  # noqa: E402
import update_judge  # noqa: E402
import update_models  # noqa: E402
import update_solids as solids  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import page, paper, scanmill  # noqa: E402
from tables.ply import write_ply  # noqa: E402
from update_solids import Array, Mesh  # noqa: E402

SEED = 2005
WORKFLOW = BENCH / "quality" / "mesh-update.yaml"
#: Phases of the paper's table, and our metrics.
PHASES = {"boundary": "boundary-seconds", "overlap": "overlap-seconds", "segmentation": "segmentation-seconds",
          "reconstruction": "reconstruction-seconds"}
ROUNDING = 0.01  #: of points of the scan that are on the solid, in its units
#: Width of the ring of unchanged surface that a cloud shows, in spacings of the cloud.
RING = 6
COUNTS = ("initial", "resampled", "added", "discarded", "kept", "unused-points", "groups", "replaced")


@dataclass
class Change:
    """A solid, the changed solid, and the new faces of each cloud."""

    model: Mesh
    truth: Mesh
    parts: list[Mesh]


@dataclass(frozen=True)
class Example:
    paper: str  #: the object's name; empty: not in the paper
    what: str
    initial: int
    cloud: int
    updated: int  #: 0: not in the paper
    seconds: tuple[float, ...]  #: of the paper's phases
    make: Callable[[], Change]


def changed(model: manifold3d.Manifold, tools: list[manifold3d.Manifold], added: bool) -> Change:
    truth = model
    for tool in tools:
        truth = truth + tool if added else truth - tool
    made = solids.mesh_of(truth)
    parts = [made.part(numpy.isin(made.origin, list(solids.origins(tool)))) for tool in tools]
    return Change(solids.mesh_of(model), made, parts)


def one(solid: manifold3d.Manifold) -> manifold3d.Manifold:
    """The solid as one origin, so that all its faces belong to one part."""
    return solid.as_original()


Cube, Rod, Ball = manifold3d.Manifold.cube, manifold3d.Manifold.cylinder, manifold3d.Manifold.sphere
ROUND = 128  #: facets around a circle


def block() -> manifold3d.Manifold:
    return one(Cube((60, 40, 20), True) - Cube((60, 14, 8)).translate((-30, -20, 4)))


def block_and_u() -> Change:
    pad = Cube((30, 20, 5)).translate((-15, -3, 8)) - Cube((12, 14, 9)).translate((-6, 3, 7))
    return changed(block(), [one(pad)], True)


def block_and_hole() -> Change:
    return changed(block(), [Rod(60, 5, 5, ROUND, True).translate((-14, 7, 0))], False)


def airbag() -> Change:
    plate = Cube((120, 90, 14), True) + Ball(40, ROUND).scale((1, 1, 0.5)).translate((0, 0, -3))
    tools = [Rod(10, 8, 8, ROUND).translate((-45, -28, 2)), Cube((18, 14, 10), True).translate((44, 28, 7)),
             Rod(10, 9, 5, ROUND).mirror((0, 0, 1)).translate((45, -26, 11))]
    return changed(one(plate), tools, False)


def golf_club() -> Change:
    """A bump beside a dent: the change lies on both sides of the model."""
    base = solids.sphere(60_000)
    x, y, z = base.vertices.T
    club = numpy.stack([x * (1 + 0.003 * z), 0.45 * y, 0.7 * z + 0.004 * x**2], axis=1)
    rows = numpy.argmax(y)
    away = numpy.linalg.norm(club - club[rows], axis=1)
    window = numpy.where((away < 17) & (y > 0), (1 - (away / 17) ** 2) ** 2, 0)
    moved = club.copy()
    moved[:, 1] += 1.6 * window * numpy.sin((club[:, 0] - club[rows, 0]) / 4)
    truth = Mesh(moved, base.faces)
    return Change(Mesh(club, base.faces), truth, [truth.part((window[base.faces] > 0).any(axis=1))])


def joystick() -> manifold3d.Manifold:
    return one(Ball(1, ROUND).scale((38, 32, 14)) + Rod(48, 8, 7, ROUND) +
               Ball(1, ROUND).scale((14, 14, 19)).translate((0, 0, 52)))


def joystick_1() -> Change:
    button = Rod(12, 5, 4, ROUND).translate((0, 0, 8)) + Ball(4, ROUND).translate((0, 0, 20))
    return changed(joystick(), [one(button.rotate((0, 60, 0)).translate((0, 0, 52)))], True)


def joystick_2() -> Change:
    grip = Ball(12, ROUND).translate((9, 0, 62)) + Ball(10, ROUND).translate((13, 0, 50))
    grip += Ball(9, ROUND).translate((2, 0, 74))
    return changed(joystick(), [one(grip)], True)


EXAMPLES = [
    Example("test block", "a block with a step, and a U on it", 5991, 11488, 17057, (62.27, 29.70, 1.22, 44.86),
            block_and_u),
    Example("airbag", "a plate with a dome, and three pockets", 28650, 34866, 60959, (150.02, 228.05, 10.97, 337.32),
            airbag),
    Example("golf club", "a free form, and a bump beside a dent", 49380, 4572, 53570, (9.25, 75.265, 7.42, 388.80),
            golf_club),
    Example("joystick I", "base, stem and knob, and a button", 37122, 10574, 45893, (24.73, 134.34, 7.45, 370.80),
            joystick_1),
    Example("joystick II", "the same, and a grip", 37122, 32187, 65956, (204.00, 170.88, 8.86, 367.12), joystick_2),
    Example("", "the block, and a through-hole", 5991, 4000, 0, (), block_and_hole),
]


def thinned_to(points: Array, count: int) -> Array:
    """`count` of the points, evenly spread: the largest least distance that leaves enough, then a random choice."""
    random = numpy.random.default_rng(SEED)
    points = points[random.permutation(len(points))]
    if len(points) < count:
        raise scanmill.Broken(f"a scan of {len(points)} points, fewer than {count}")
    low, high = 0.0, float(numpy.linalg.norm(numpy.ptp(points, axis=0)) / numpy.sqrt(count) * 2)
    best = points
    for _ in range(14):
        middle = (low + high) / 2
        found = points[update_cases.thinned(points, middle)]
        if len(found) >= count:
            low, best = middle, found
            if len(found) <= 1.01 * count:
                break
        else:
            high = middle
    return best[numpy.sort(random.choice(len(best), count, replace=False))]


def scan(options: Namespace, shape: Mesh, part: Mesh, count: int, within: float, folder: pathlib.Path) -> Array:
    """`count` points of the shape near the part, seen from 30 views."""
    spacing = float(numpy.sqrt(part.area / count))
    model = update_models.write(folder, "shape.ply", shape)
    used, faces = numpy.unique(part.faces, return_inverse=True)
    near = update_models.write(folder, "part.ply", Mesh(part.vertices[used], faces.reshape(-1, 3)))
    report = scanmill.run(options.program, BENCH / "quality" / "update-scan.yaml", [model], folder / "scan",
                          options.limit, inputs={"part": near},
                          settings={"resolution": f"{0.7 * spacing} u", "within": f"{within} u"})
    file = report["cells"][0]["outputs"][0]["file"]
    return thinned_to(update_models.load_points(pathlib.Path(file)), count)


def prepared(options: Namespace, example: Example,
             folder: pathlib.Path) -> tuple[Change, pathlib.Path, list[pathlib.Path]]:
    """The change, the file of the model and those of the clouds."""
    change = example.make()
    points = scan(options, change.model, change.model, example.initial, ROUNDING, folder / "initial")
    write_ply(folder / "initial.ply", points)
    model = update_models.surface_of(options.program, folder / "initial.ply", folder / "model", options.limit)
    clouds = []
    for number, part in enumerate(change.parts):
        count = example.cloud // len(change.parts)
        within = RING * float(numpy.sqrt(part.area / count))
        cloud = scan(options, change.truth, part, count, within, folder / f"cloud-{number}")
        clouds.append(folder / f"cloud-{number}.ply")
        write_ply(clouds[-1], cloud)
    return change, model, clouds


def judged(report: dict, change: Change) -> dict:
    cell = report["cells"][0]
    if cell["outcome"] not in ("ok", "doubtful"):
        return {"failure": str(cell.get("error", cell["outcome"]))}
    step = scanmill.steps(report, cell)["mesh-update"]
    metrics = step["metrics"]
    result = update_judge.Result.load(pathlib.Path(scanmill.mesh(cell)["file"]))
    area = float(result.mesh.areas[result.updated].sum())
    return {**{name: int(metrics[name]) for name in COUNTS}, "euler": result.mesh.euler,
            "true_euler": change.truth.euler, "closed": solids.is_closed(result.mesh),
            "volume": (result.mesh.volume() - change.truth.volume()) / area,
            "doubts": [doubt.removeprefix("mesh-update: ") for doubt in cell.get("doubts", [])],
            "seconds": {"total": step["seconds"], **{name: metrics[metric] for name, metric in PHASES.items()}}}


def run(options: Namespace, folder: pathlib.Path) -> dict:
    entries = []
    for number, example in enumerate(EXAMPLES):
        entry: dict = {"paper": example.paper, "file": example.what, "failure": ""}
        entries.append(entry)
        into = folder / str(number)
        try:
            change, model, clouds = prepared(options, example, into)
        except scanmill.Broken as broken:
            entry["failure"] = str(broken)
            continue
        for round_ in range(options.rounds):
            for threads in ("1", "all"):
                report = scanmill.run(options.program, WORKFLOW, [model], into / f"{threads}-{round_}", options.limit,
                                      threads=1 if threads == "1" else 0,
                                      inputs={"clouds": ",".join(str(cloud) for cloud in clouds)})
                paper.take(entry, judged(report, change), threads)
    return {"updates": entries}


HEADER = ["example", "initial", "cloud", "updated", "discarded", "unused", "groups", "replaced", "Euler number (truth)",
          "volume − truth's, per updated area", *PHASES, "total"]

NOTES = """\
Lines in bold are printed in the paper (Visual C++ and CGAL, Pentium IV of 1.6 GHz, 512 MB). **None of our models is
the paper's data**, which is not published. The lines below them are ours: solids made by a script, scanned from 30
views and thinned to the paper's numbers of points. The model is tight-cocone's mesh of the initial points; *initial*
counts its vertices: fewer than the points if some stay unused. A cloud shows the change and a ring of {ring} spacings
around it. Compare times, not shapes.

*updated* counts the points from which the updated surface is made: kept + added = initial + resampled + added −
discarded, in the paper's lines and in ours. *unused* of them are not on the surface. In the paper, *discarded* is the
difference of its other numbers. Times are those of the phases as the filter measures them, with one thread and, after
the slash, with all threads (median of {rounds} rounds); *total* is that of the whole filter."""


def middle(entry: dict, threads: str, phase: str) -> float:
    return statistics.median(seconds[phase] for seconds in entry["seconds"][threads])


def printed_line(example: Example) -> list[str]:
    gone = example.initial + example.cloud - example.updated
    return [f"**{example.paper}**", f"{example.initial:,}", f"{example.cloud:,}", f"{example.updated:,}", f"{gone:,}",
            *[""] * 5, *(f"{seconds:.2f} s" for seconds in example.seconds), f"{sum(example.seconds):.2f} s"]


def our_line(entry: dict) -> list[str]:
    if entry["failure"]:
        return [entry["file"], "failed", *[""] * (len(HEADER) - 2)]
    times = [f"{middle(entry, '1', phase):.3f} / {middle(entry, 'all', phase):.3f} s" for phase in (*PHASES, "total")]
    return [entry["file"], f"{entry['initial']:,}", f"{entry['added']:,}", f"{entry['kept'] + entry['added']:,}",
            f"{entry['discarded']:,}", f"{entry['unused-points']:,}", str(entry["groups"]), str(entry["replaced"]),
            f"{entry['euler']} ({entry['true_euler']})", f"{entry['volume']:+.3f} u", *times]


def lines(results: dict) -> list[str]:
    rows = []
    for example, entry in zip(EXAMPLES, results["updates"], strict=True):
        if example.paper:
            rows.append(printed_line(example))
        rows.append(our_line(entry))
    text = page.heading("The updates of Table 1 of Woo and Dey 2005, compared with Scanmill", results,
                        "woo-dey-updates.json")
    text += [NOTES.format(rounds=results["rounds"], ring=RING), "", *page.table(HEADER, rows), ""]
    for entry in results["updates"]:
        text += [f"{entry['file'].capitalize()}: {doubt}." for doubt in entry.get("doubts", [])]
    return [*text, "", page.other_load(results["load"])]


def main() -> int:
    parser = options_of.of_a_paper("Compares the updates of the paper's Table 1 with ours.", WORKFLOW)
    return paper.write("woo-dey-updates", parser.parse_args(), run, lines, tried="updates")


if __name__ == "__main__":
    sys.exit(main())
