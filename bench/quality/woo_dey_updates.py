#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""woo_dey_updates.py PROGRAM: compares the updates of Table 1 of Woo, Dey 2005 with ours.

The paper updates models by locally added clouds. For each of its examples a script makes a similar solid and a changed
one, and spreads as many points as the paper has on the solid and on the change. tight-cocone makes the model, and
mesh-update adds the clouds, ROUNDS times with one thread and with all threads, without a cache. Every count and time
comes from the program's JSON. One more case adds a view of a real scan that was left out of the model
(left_out_view.py). Writes woo-dey-updates.md and .json. The exit code is 1 if a run failed or a mesh has a wrong
topology.
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

import left_out_view  # noqa: E402
import update_cases  # noqa: E402
import update_judge  # noqa: E402
import update_models  # noqa: E402
import update_solids as solids  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import page, paper, scanmill  # noqa: E402
from tables.ply import write_ply  # noqa: E402
from update_cases import Change  # noqa: E402
from update_solids import Array, Mesh  # noqa: E402

SEED = 2005
WORKFLOW = BENCH / "quality" / "mesh-update.yaml"
#: The paper's phases and one of ours, and our metrics. The paper prints no time for its search structure.
PHASES = {"boundary": "boundary-seconds", "model": "model-seconds", "overlap": "overlap-seconds",
          "segmentation": "segmentation-seconds", "reconstruction": "reconstruction-seconds"}
PRINTED = ("boundary", "overlap", "segmentation", "reconstruction")
#: Width of the ring of unchanged surface that a cloud shows, in spacings of the cloud.
RING = 6
#: Clouds are made with up to this many times the points that the paper has, and lose the rest at random.
SURPLUS = 1.02
TRIES = 8
COUNTS = ("initial", "resampled", "added", "discarded", "kept", "unused-points", "groups", "replaced")


@dataclass(frozen=True)
class Example:
    paper: str  #: the object's name; empty: not in the paper
    what: str
    initial: int
    cloud: int
    updated: int  #: 0: not in the paper
    seconds: tuple[float, ...]  #: of the paper's phases
    rims: int  #: of each cloud
    make: Callable[[], tuple[manifold3d.Manifold, list[Change]]]


def changes(model: manifold3d.Manifold, steps: list[tuple[manifold3d.Manifold, bool]],
            together: bool = False) -> tuple[manifold3d.Manifold, list[Change]]:
    """The model and its changes by tools that are added or removed, in this order. All changes have the same truth;
    with `together` there is one, of all tools."""
    truth = model
    for tool, added in steps:
        truth = truth + tool if added else truth - tool
    made = solids.mesh_of(truth)
    groups = [[tool for tool, _ in steps]] if together else [[tool] for tool, _ in steps]
    return model, [Change(truth, made, gone(model, group), [one for tool in group for one in solids.origins(tool)])
                   for group in groups]


def gone(model: manifold3d.Manifold, tools: list[manifold3d.Manifold]) -> Mesh:
    """The model's faces inside the tools."""
    common = solids.mesh_of(model ^ manifold3d.Manifold.batch_boolean(tools, manifold3d.OpType.Add))
    return common.part(numpy.isin(common.origin, list(solids.origins(model))))


def one(solid: manifold3d.Manifold) -> manifold3d.Manifold:
    """The solid as one origin, so that all its faces belong to one part."""
    return solid.as_original()


Cube, Rod, Ball = manifold3d.Manifold.cube, manifold3d.Manifold.cylinder, manifold3d.Manifold.sphere
ROUND = 128  #: facets around a circle


def block() -> manifold3d.Manifold:
    return one(Cube((70, 50, 20), True) - Cube((70, 10, 8)).translate((-35, -25, 2)))


def block_and_u() -> tuple[manifold3d.Manifold, list[Change]]:
    arms = Cube((40, 28, 36)).translate((-20, -9, 8)) - Cube((20, 20, 40)).translate((-10, 1, 7))
    return changes(block(), [(one(arms), True)])


def block_and_hole() -> tuple[manifold3d.Manifold, list[Change]]:
    return changes(block(), [(Rod(60, 9, 9, ROUND, True).translate((-14, 5, 0)), False)])


def airbag() -> tuple[manifold3d.Manifold, list[Change]]:
    body = Cube((126, 88, 40), True) + Ball(38, ROUND).scale((1, 1, 0.5)).translate((0, 0, -17))
    cone = Rod(36, 20, 16, ROUND).mirror((0, 0, 1)).translate((0, 18, 22))
    pockets = [Rod(36, 18, 18, ROUND).translate((-42, -18, -14)), Cube((34, 34, 36)).translate((22, -38, -14)), cone]
    return changes(one(body), [(pocket, False) for pocket in pockets])


def golf_club() -> tuple[manifold3d.Manifold, list[Change]]:
    """A bump beside a dent: the change lies on both sides of the model."""
    x, y, z = solids.sphere(60_000).vertices.T
    face = numpy.stack([x * (1 + 0.003 * z), 0.45 * y, 0.7 * z + 0.004 * x**2], axis=1)
    club = solids.solid_of(Mesh(face, solids.sphere(60_000).faces))
    top = face[numpy.argmax(face[:, 1])]
    bump = Ball(14, ROUND).translate(tuple(top + [-8, -10, 0]))
    dent = Ball(14, ROUND).translate(tuple(top + [8, 10, 0]))
    return changes(club, [(bump, True), (dent, False)], together=True)


def joystick() -> manifold3d.Manifold:
    return one(Ball(1, ROUND).scale((34, 30, 12)) + Rod(48, 8, 7, ROUND) +
               Ball(1, ROUND).scale((20, 20, 26)).translate((0, 0, 60)))


def joystick_1() -> tuple[manifold3d.Manifold, list[Change]]:
    button = Rod(40, 9, 8, ROUND) + Ball(8, ROUND).translate((0, 0, 40))
    return changes(joystick(), [(one(button.rotate((0, 60, 0)).translate((0, 0, 60))), True)])


def joystick_2() -> tuple[manifold3d.Manifold, list[Change]]:
    grip = Ball(17, ROUND).translate((24, 0, 70)) + Ball(15, ROUND).translate((36, 0, 52))
    grip += Ball(14, ROUND).translate((8, 0, 92))
    return changes(joystick(), [(one(grip), True)])


EXAMPLES = [
    Example("test block", "a block with a step, and a U on it", 5991, 11488, 17057, (62.27, 29.70, 1.22, 44.86), 1,
            block_and_u),
    Example("airbag", "a block with a dome, and three pockets", 28650, 34866, 60959, (150.02, 228.05, 10.97, 337.32),
            1, airbag),
    Example("golf club", "a free form, and a bump beside a dent", 49380, 4572, 53570, (9.25, 75.265, 7.42, 388.80), 1,
            golf_club),
    Example("joystick I", "base, stem and knob, and a button", 37122, 10574, 45893, (24.73, 134.34, 7.45, 370.80), 1,
            joystick_1),
    Example("joystick II", "the same, and a grip", 37122, 32187, 65956, (204.00, 170.88, 8.86, 367.12), 1, joystick_2),
    Example("", "the block, and a through-hole", 5991, 2000, 0, (), 2, block_and_hole),
]


def exactly(count: int, area: float, points_of: Callable[[float, numpy.random.Generator], Array]) -> Array:
    """`count` evenly spread points. `points_of` makes some of a spacing."""
    spacing = float(numpy.sqrt(update_cases.PER_SQUARE * area / count))
    for _ in range(TRIES):
        random = numpy.random.default_rng(SEED)
        points = points_of(spacing, random)
        if count <= len(points) <= SURPLUS * count:
            return points[numpy.sort(random.choice(len(points), count, replace=False))]
        spacing *= float(numpy.sqrt(len(points) / count * (2 / (1 + SURPLUS))))
    raise scanmill.Broken(f"no spacing gives {count} points")


def spread(mesh: Mesh, spacing: float, random: numpy.random.Generator) -> Array:
    count = int(update_cases.TRIED * update_cases.PER_SQUARE * mesh.area / spacing**2)
    places, _ = update_cases.uniform(mesh, count, random)
    return places[update_cases.thinned(places, update_cases.LEAST * spacing)]


def scan(change: Change, count: int, rims: int) -> Array:
    """Points of the change and of a ring around it."""
    def points_of(spacing: float, random: numpy.random.Generator) -> Array:
        return update_cases.scan_of_change(change, spacing, RING * spacing, rims, random, most=4 * count).clean

    try:
        return exactly(count, change.changed().area, points_of)
    except update_cases.Unsuitable as unsuitable:
        raise scanmill.Broken(f"the solids are unsuitable: {unsuitable}") from None


@dataclass
class Prepared:
    model: pathlib.Path
    clouds: list[pathlib.Path]
    truth: Mesh
    faults: list[str]  #: of the model
    ratio: float  #: median edge of the model to the spacing of the densest cloud


def prepared(options: Namespace, example: Example, folder: pathlib.Path) -> Prepared:
    solid, parts = example.make()
    folder.mkdir(parents=True)
    before = solids.mesh_of(solid)
    write_ply(folder / "initial.ply", exactly(example.initial, before.area,
                                              lambda spacing, random: spread(before, spacing, random)))
    file = update_models.surface_of(options.program, folder / "initial.ply", folder / "model", options.limit)
    model = update_models.load(file)
    faults = [] if solids.is_closed(model) else ["the model is not closed"]
    if model.euler != before.euler:
        faults.append(f"the model has the Euler number {model.euler} instead of {before.euler}")
    clouds, spacings = [], []
    for number, part in enumerate(parts):
        points = scan(part, example.cloud // len(parts), example.rims)
        clouds.append(folder / f"cloud-{number + 1}.ply")
        write_ply(clouds[-1], points)
        spacings.append(update_cases.median_nearest(points))
    return Prepared(file, clouds, parts[0].mesh, faults, model.median_edge / min(spacings))


def judged(report: dict, case: Prepared) -> dict:
    cell = report["cells"][0]
    if cell["outcome"] not in ("ok", "doubtful"):
        return {"failure": str(cell.get("error", cell["outcome"])).partition("\n")[0]}
    step = scanmill.steps(report, cell)["mesh-update"]
    metrics = step["metrics"]
    counts = {name: int(metrics[name]) for name in COUNTS}
    result = update_judge.Result.load(pathlib.Path(scanmill.mesh(cell)["file"]))
    faults = [*case.faults]
    if not solids.is_closed(result.mesh):
        faults.append("not closed")
    if result.mesh.euler != case.truth.euler:
        faults.append(f"Euler number {result.mesh.euler} instead of {case.truth.euler}")
    if counts["kept"] != counts["initial"] + counts["resampled"] - counts["discarded"]:
        faults.append("the counts do not add up")
    if faults:
        return {"failure": "; ".join(faults)}
    area = float(result.mesh.areas[result.updated].sum())
    return {**counts, "euler": result.mesh.euler, "true_euler": case.truth.euler,
            "volume": (result.mesh.volume() - case.truth.volume()) / area,
            "doubts": [doubt.removeprefix("mesh-update: ") for doubt in cell.get("doubts", [])],
            "seconds": {"total": step["seconds"], **{name: metrics[metric] for name, metric in PHASES.items()}}}


def run(options: Namespace, folder: pathlib.Path) -> dict:
    entries = []
    for number, example in enumerate(EXAMPLES):
        entry: dict = {"paper": example.paper, "file": example.what, "failure": "",
                       "local": {"file": f"{example.what}, rebuild: local", "failure": ""}}
        entries.append(entry)
        try:
            case = prepared(options, example, folder / str(number))
        except scanmill.Broken as broken:
            entry["failure"] = str(broken)
            continue
        entry["ratio"] = case.ratio
        for round_ in range(options.rounds):
            for threads in ("1", "all"):
                for rebuild, into in (("whole", entry), ("local", entry["local"])):
                    report = scanmill.run(options.program, WORKFLOW, [case.model],
                                          folder / f"{number}/{rebuild}-{threads}-{round_}", options.limit,
                                          threads=1 if threads == "1" else 0, settings={"rebuild": rebuild},
                                          inputs={"clouds": ",".join(str(cloud) for cloud in case.clouds)})
                    paper.take(into, judged(report, case), threads)
                    if into["failure"] and report["cells"][0].get("cause") != "refused":  # a local rebuild may refuse
                        entry["failure"] = into["failure"]
    return {"updates": entries, "view": left_out_view.record(options, folder / "view")}


HEADER = ["example", "initial", "cloud", "resampled", "discarded", "updated", "unused", "genus",
          "volume − truth's, per updated area", *PHASES, "total", "total, local"]

NOTES = """\
Lines in bold are printed in the paper (Visual C++ and CGAL, Pentium IV of 1.6 GHz, 512 MB). **None of our models is
the paper's data**, which is not published. The lines below them are ours: solids made by a script, with the paper's
numbers of points spread evenly on them, so compare times, not shapes. The model is tight-cocone's mesh of the initial
points; *initial* counts its vertices: fewer than the points if some stay unused. A cloud shows a change and a ring of
{ring} spacings around it. The changes are so large that the clouds are at most a few times as dense as the model: the
filter splits longer edges of the model than 4 spacings of the densest cloud (*resampled*), which the paper does not
do.

*updated* counts the points from which the updated surface is made, in the paper and in our lines: initial + resampled +
cloud − discarded. In the paper, *discarded* is the difference of its other numbers. *unused* points are not on the
surface. *genus* is that of the result and, in brackets, of the truth, the exact boolean of the solids; a mesh with
another one counts as a failure, as does a model with another one before the change. *volume* is in the length unit of
the models, which are about 100 units long.

Times are those of the phases as the filter measures them, with one thread and, after the slash, with all threads
(median of {rounds} rounds). *model* splits long edges and builds the search tree; the paper does not list such a phase.
*total* is the time of the whole filter with `rebuild: whole`, the paper's method, *total, local* that with `rebuild:
local`."""


def middle(entry: dict, threads: str, phase: str) -> float:
    return statistics.median(seconds[phase] for seconds in entry["seconds"][threads])


def both(entry: dict, phase: str) -> str:
    if entry["failure"]:
        return "failed"
    return f"{middle(entry, '1', phase):.3f} / {middle(entry, 'all', phase):.3f} s"


def printed_line(example: Example) -> list[str]:
    gone = example.initial + example.cloud - example.updated
    times = dict(zip(PRINTED, example.seconds, strict=True))
    return [f"**{example.paper}**", f"{example.initial:,}", f"{example.cloud:,}", "", f"{gone:,}",
            f"{example.updated:,}", "", "", "", *(f"{times[name]:.2f} s" if name in times else "" for name in PHASES),
            f"{sum(example.seconds):.2f} s", ""]


def genus(euler: int) -> int:
    return 1 - euler // 2


def our_line(entry: dict) -> list[str]:
    if entry["failure"]:
        return [entry["file"], "failed", *[""] * (len(HEADER) - 2)]
    return [entry["file"], f"{entry['initial']:,}", f"{entry['added']:,}", f"{entry['resampled']:,}",
            f"{entry['discarded']:,}", f"{entry['kept'] + entry['added']:,}", f"{entry['unused-points']:,}",
            f"{genus(entry['euler'])} ({genus(entry['true_euler'])})", f"{entry['volume']:+.3f}",
            *(both(entry, phase) for phase in PHASES), both(entry, "total"), both(entry["local"], "total")]


def sentences(entry: dict) -> list[str]:
    """The failures and doubts of an example, and a warning if its cloud is much denser than its model."""
    name = entry["file"][0].upper() + entry["file"][1:]
    found = []
    for made, words in ((entry, name), (entry["local"], f"{name}, `rebuild: local`")):
        if made["failure"]:
            found.append(f"{words}: failed: {made['failure'].partition(chr(10))[0]}.")
        found += [f"{words}: doubtful: {doubt}." for doubt in made.get("doubts", [])]
    if entry.get("resampled"):
        found.append(f"{name}: the model's median edge is {entry['ratio']:.1f} spacings of the densest cloud, so "
                     f"{entry['resampled']:,} vertices were added to the model.")
    return found


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
        for sentence in sentences(entry):
            text += [sentence, ""]
    return [*text, *left_out_view.lines(results["view"]), "", page.other_load(results["load"])]


def main() -> int:
    parser = options_of.of_a_paper("Compares the updates of the paper's Table 1 with ours.", WORKFLOW)
    return paper.write("woo-dey-updates", parser.parse_args(), run, lines, tried="updates")


if __name__ == "__main__":
    sys.exit(main())
