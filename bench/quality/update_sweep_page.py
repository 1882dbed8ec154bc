# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of update_sweep.py."""
from __future__ import annotations

from collections.abc import Callable

import update_cases
import update_judge
from tables import page
from update_judge import OUTCOMES
from update_solids import FEATURES

#: Upper ends of the ranges of density ratios.
RATIOS = ((1 / 4, "1/16 to 1/4"), (1, "1/4 to 1"), (4, "1 to 4"), (float("inf"), "4 to 16"))

NOTES = f"""\
Every case has a closed model and a feature that is added to it or removed from it at a random position. The truth is
the exact boolean of the two polyhedra. The cloud is what a scan of the change gives: evenly spread points of it, on
the whole change and on a ring of the unchanged model around it, {update_cases.RING[0]:g} to {update_cases.RING[1]:g} h
wide, without normals. h is the median distance of nearest neighbours in the cloud. All points are moved together by at
most {update_cases.SHIFT:g} h, an error of registration, and each by noise with a standard deviation sigma of at most
{update_cases.NOISE:g} h per coordinate. Features are {update_cases.WIDTH[0]:g} to {update_cases.WIDTH[1]:g} h wide,
clouds have {update_cases.POINTS[0]:,} to {update_cases.POINTS[1]:,} points, models that are not CAD models about
{update_cases.VERTICES[0]:,} to {update_cases.VERTICES[1]:,} vertices. Walls are at least {update_cases.WALL:g} spacings
thick, of the coarser sampling on their sides; {100 * update_cases.THIN_SHARE:g} % of the cloud may lie on thinner ones,
as beside convex edges. The *ratio* is that of the points per area of the cloud to the vertices per area of the model.
CAD models have few vertices, which the filter resamples.

Three rules keep cases away that no program could decide, or that are not local changes. Draws that break one are drawn
again:

- a cloud covers at most {100 * update_cases.LARGEST_SHARE:g} % of the surface, and a feature is at most
  {100 * update_cases.THICKEST_SHARE:g} % as wide as the model's shortest extent;
- a cloud has one rim, that of a through-hole two: both the outermost band of the cloud, {update_cases.BAND:g} h wide,
  and the band of the model beside it have as many connected components as there are rims, and the latter does not have
  far fewer points, as where the rim nearly meets itself;
- the change replaces one connected part of the model by one, of a through-hole two parts by one, and adds no other
  handle.

A mesh is **right** if

- it is closed and has the truth's Euler number;
- its volume differs from the truth's by at most (h / 2 + 3 sigma h) times the area of the updated faces;
- {update_judge.QUANTILE} % of {update_judge.SAMPLES:,} points of the updated faces are at most h + 3 sigma h from the
  truth, and as many points of the truth in the cloud's region from the mesh;
- every kept vertex has the coordinates of one of the model bit for bit (a CAD model's may also be one of those that
  resampling adds), every new one those of a point of the cloud.

A refusal is **admissible**, by rules that see the case and not the result, for one reason: `registration`, where the
median distance of the cloud's rim from the model is above {update_judge.REGISTRATION:g} median distances of nearest
neighbours of the cloud with its errors (the filter's limit is 0.5, its border is not exactly our rim). With
`rebuild: local`, `seam` is admissible, too. `no separation` is never admissible: by construction the ring encloses the
change, so the rims together separate it from the rest of the model, on a torus as well. `hanging` and `ambiguous` are
not either: all rims lie on the unchanged model, and the surface continues across them."""


def table_of(records: list[dict], group_of: Callable[[dict], str | None], groups: list[str]) -> list[list]:
    rows = []
    for group in groups:
        members = [record for record in records if group_of(record) == group]
        if members:
            counts = [sum(record["outcome"] == outcome for record in members) for outcome in OUTCOMES]
            rows.append([group, len(members), *[count or "" for count in counts]])
    return rows


def ratio_of(record: dict) -> str:
    if record["ratio"] is None:
        return "ratio of CAD models"
    return "ratio " + next(name for end, name in RATIOS if record["ratio"] < end)


def groups_of(records: list[dict]) -> list[tuple[Callable[[dict], str | None], list[str]]]:
    features = [f"{sign} {feature}" for feature in FEATURES for sign in ("added", "removed")]
    return [(lambda record: "all", ["all"]),
            (lambda record: record["kind"], list(update_cases.KINDS)),
            (lambda record: ("added " if record["added"] else "removed ") + record["feature"], features),
            (ratio_of, [*("ratio " + name for _, name in RATIOS), "ratio of CAD models"])]


def line_of(record: dict) -> str:
    """A record in one line, for the terminal."""
    return f"{record['index']} {record['model']} {'+' if record['added'] else '-'}{record['feature']}: " \
           f"{OUTCOMES[record['outcome']]} {record.get('reason', '')}"


def row_of(record: dict) -> list:
    ratio = "" if record["ratio"] is None else f"{record['ratio']:.2g}"
    position = " ".join(f"{x:.1f}" for x in record["position"])
    return [record["index"], record["model"], f"{record['vertices']:,}",
            ("added " if record["added"] else "removed ") + record["feature"], f"{record['points']:,}",
            f"{record['h']:.3g}", f"{record['width']:.0f}", ratio, f"{record['sigma']:.2f}", f"{record['shift']:.2f}",
            f"{record['rim_offset']:.2f}", OUTCOMES[record["outcome"]], record.get("reason", ""), position]


def seams(records: list[dict]) -> str:
    words = []
    for name, members in (("models made by tight-cocone", [r for r in records if r["kind"] == "tight cocone"]),
                          ("other models", [r for r in records if r["kind"] != "tight cocone"])):
        found = sum("seam" in record["reason"] for record in members if record["outcome"] in ("admissible", "refused"))
        if members:
            words.append(f"{found} of {len(members)} ({100 * found / len(members):.0f} %) of the {name}")
    return "Refused with `seam`: " + ", ".join(words) + "."


def lines_of(results: dict, name: str) -> list[str]:
    records = results["cases"]
    title = f"Models updated by scans of a change, `rebuild: {results['rebuild']}`"
    lines = [*page.heading(title, results, f"{name}.json"), NOTES, ""]
    lines += [f"Seed {results['seed']}. `update_sweep.py PROGRAM --only INDEX --keep FOLDER` runs one case again and "
              "keeps its files.", ""]
    for sentence in results["missing"]:
        lines += [f"Missing: {sentence}.", ""]
    low = update_cases.LOW_NOISE
    for words, members in ((f"Noise of at most {low:g} h", [r for r in records if r["sigma"] <= low]),
                           (f"Noise of {low:g} to {update_cases.NOISE:g} h", [r for r in records if r["sigma"] > low])):
        rows = [row for group_of, groups in groups_of(members) for row in table_of(members, group_of, groups)]
        lines += [f"## {words}", "", *page.table(["cases", "number", *OUTCOMES.values()], rows), ""]
    if results["rebuild"] == "local":
        lines += [seams(records), ""]
    rest = [record for record in records if record["outcome"] != "right"]
    lines += ["## Cases that are not right", ""]
    if rest:
        header = ["index", "model", "vertices", "feature", "points", "h", "width / h", "ratio", "sigma / h",
                  "shift / h", "rim / h", "outcome", "reason", "position"]
        lines += page.table(header, [row_of(record) for record in rest])
    else:
        lines += ["All are right."]
    return [*lines, "", page.other_load(results["load"])]
