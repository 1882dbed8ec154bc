# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of raw_scans.py: distances, topology and outcomes, and which goals our results miss."""
from tables import page

OURS = ("quickstart", "raw-scans")
#: Only for open models.
KEEP = "raw-scans, outer: keep"
NOTES = """\
Every model is scanned by `virtual-scan` from 20 views with rays 0.5 % of the diagonal apart, without noise and with
noise of 0.05 % of the diagonal (standard deviation, along the ray). All programs get the points of all views in one
file, without normals. *quickstart* and *raw-scans* are our workflows at their defaults. Open3D's *Poisson* (depth 8)
gets normals of 25 neighbours with correct signs, from the model's nearest triangle, which real scans do not have.
*Ball pivoting* gets the same normals, and one point per voxel of 0.5 %, the mean of the voxel's points; the radii are 1, 1.5, 2 and 3 mean distances of its nearest neighbours.

*mean* and *largest* are distances between mesh and model, in both directions, in percent of the diagonal; *F* is the
F-score at 0.5 % of the diagonal. *pieces*, *loops* and *genus* are those of the mesh (of raw-scans in brackets: pieces
and loops of region-grow, before holes are filled), in the row of the model those that it has. *cuts* counts pairs of
intersecting triangles. *seconds* is the time of the steps, for the others with the normals. *misses* names the goals
that one of our results misses:

- *mean*: of a closed model with noise, larger than that of Poisson.
- *pieces*: not those of the model.
- *loops*: not those of the model; `raw-scans` leaves only surfaces open that a flat filling would enlarge by 40 %, and with
  `outer: keep` also bases and necks. The line of `outer: keep` is that of open models only.
- *genus*: not that of the model.
- *cuts*: more than the model has.
- *ball*: more pieces or more loops than ball pivoting."""


def grown(facts):
    """Pieces and loops before holes are filled."""
    if "grown" in facts:
        return facts["grown"]["components"], facts["grown"]["loops"]
    return facts["pieces"], facts["loops"]


def misses(record, name):
    """The goals that a result of ours misses, as words."""
    facts, truth = record["surfaces"][name], record["truth"]
    if "pieces" not in facts:
        return ["no mesh"]
    closed, poisson, ball = truth["loops"] == 0, record["surfaces"]["Poisson"], record["surfaces"]["ball pivoting"]
    found = []
    if closed and record["noise"] > 0 and facts["mean"] > poisson["mean"]:
        found.append("mean")
    pieces, loops = grown(facts)
    if facts["pieces"] != truth["pieces"]:
        found.append("pieces")
    if facts["loops"] != truth["loops"]:
        found.append("loops")
    if facts["genus"] != truth["genus"]:
        found.append("genus")
    if facts["intersections"] > truth["intersections"]:
        found.append("cuts")
    if pieces > ball["pieces"] or loops > ball["loops"]:
        found.append("ball")
    return found


def rows_of(record):
    truth = record["truth"]
    rows = [["model", "", "", "", truth["pieces"], truth["loops"], truth["genus"], truth["intersections"],
             f"{truth['triangles']:,}", "", "", ""]]
    for name, facts in record["surfaces"].items():
        mine = name in (*OURS, KEEP)
        words = [facts["outcome"], ", ".join(misses(record, name))] if mine else ["", ""]
        seconds = f"{facts['seconds']:.1f}"
        if "pieces" not in facts:
            rows.append([name, *[""] * 8, seconds, *words])
            continue
        pieces, loops = (f"{facts[key]} ({before})" if "grown" in facts else facts[key]
                         for key, before in zip(("pieces", "loops"), grown(facts)))
        genus = "" if facts["genus"] is None else facts["genus"]
        rows.append([name, f"{facts['mean']:.3g}", f"{facts['largest']:.3g}", f"{100 * facts['f_score']:.1f}", pieces,
                     loops, genus, facts["intersections"], f"{facts['triangles']:,}", seconds, *words])
    return rows


def summary(records):
    """Lines with the counts over all scans."""
    lines = []
    for name in (*OURS, KEEP):
        for noise in sorted({record["noise"] for record in records}):
            mine = [record for record in records if record["noise"] == noise and name in record["surfaces"]]
            found = [(misses(record, name), record["surfaces"][name]["outcome"]) for record in mine]
            words = sorted({word for one, _ in found for word in one})
            counts = ", ".join(f"{word} {sum(word in one for one, _ in found)}" for word in words)
            silent = sum(bool(one) and outcome == "ok" for one, outcome in found)
            lines.append(f"- *{name}*, noise {noise} %: {sum(not one for one, _ in found)} of {len(mine)} scans miss "
                         f"nothing, {sum(bool(one) for one, _ in found) - silent} miss a goal and are doubtful or "
                         f"failed, {silent} miss one in silence" + (f" ({counts})." if counts else "."))
    return lines


def lines_of(results):
    lines = [*page.heading("Meshes of virtual scans", results, "raw-scans.json"), NOTES, "",
             *summary(results["records"]), ""]
    for record in results["records"]:
        lines += [f"## {record['name']}, noise {record['noise']} %, {record['points']:,} points", ""]
        lines += page.table(["surface", "mean", "largest", "F", "pieces", "loops", "genus", "cuts", "triangles",
                             "seconds", "outcome", "misses"], rows_of(record))
        lines.append("")
    return [*lines, page.other_load(results["load"])]
