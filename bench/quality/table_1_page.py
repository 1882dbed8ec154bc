# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of Table 1: the paper's lines and ours, and a sentence for each difference that matters."""
import statistics

from paper_table_1 import MACHINE, PAPER, WITHOUT
from tables import page

HEADER = ["object", "points n", "time", "tetrahedra of the alpha-solid", "per point", "removed", "share", "triangles",
          "triangles − (2n − 4)", "points left inside", "genus", "alpha / spacing"]

NOTES = """\
Lines in bold are printed in the paper ({machine}; the times are minutes, for all of it:
tetrahedralisation, alpha-shapes, choice of alpha, sculpting). Below each stand our objects of its kind, and **none of
them is the paper's data**, which is not published: so shares and counts per point can be compared, totals cannot. Ours
are delaunay, alpha-solid and sculpt in seconds, with one thread, and with all after the slash; rounds: {rounds}, the
median counts. Reading and writing files is not in ours.

A closed surface of genus 0 through all n points has 2n − 4 triangles; every point left inside takes 2 away, every
handle adds 4, and each piece beyond the first takes 4 away. The paper tells neither what it left inside nor the
genus; {exact} of its {objects} lines have exactly 2n − 4. The last column is in median distances to the nearest point,
of a mesh in median edges: sampled evenly, a surface needs about 1."""


def notes(results):
    exact = sum(paper.triangles == 2 * paper.points - 4 for paper in PAPER.values())
    return NOTES.format(machine=MACHINE, rounds=results["rounds"], exact=exact, objects=len(PAPER))


def distinct(entry):
    return entry["points"] - entry["duplicates"]


def printed_line(name):
    paper = PAPER[name]
    return [f"**{name}**", f"{paper.points:,}", f"{paper.minutes} min", f"{paper.tetrahedra:,}",
            f"{paper.tetrahedra / paper.points:.2f}", f"{paper.removed:,}",
            f"{100 * paper.removed / paper.tetrahedra:.1f} %", f"{paper.triangles:,}",
            f"{paper.triangles - 2 * paper.points + 4:+,}", "", "", ""]


def seconds(entry, threads):
    return statistics.median(entry["seconds"][threads])


def our_line(entry):
    if entry["failure"] or entry["skipped"]:
        return [entry["file"], *[""] * (len(HEADER) - 2), "failed" if entry["failure"] else "skipped"]
    count = distinct(entry)
    genus = "not closed" if not entry["closed"] else entry["genus"]
    return [entry["file"], f"{count:,}", f"{seconds(entry, '1'):.2f} / {seconds(entry, 'all'):.2f} s",
            f"{entry['tetrahedra']:,}", f"{entry['tetrahedra'] / count:.2f}", f"{entry['removed']:,}",
            f"{100 * entry['removed'] / entry['tetrahedra']:.1f} %", f"{entry['triangles']:,}",
            f"{entry['triangles'] - 2 * count + 4:+,}", f"{entry['inside'] + entry['uncovered']:,}", str(genus),
            f"{entry['alpha'] / entry['spacing']:.1f}"]


def expected_triangles(entry):
    """From points on the surface, pieces and handles: 2 V − 4 C + 4 G."""
    on_surface = distinct(entry) - entry["inside"] - entry["uncovered"]
    return 2 * on_surface - 4 * entry["components"] + 4 * entry["genus"]


def about_the_surface(entry):
    """Sentences on whether the surface is what it should be."""
    count, inside = distinct(entry), entry["inside"] + entry["uncovered"]
    if not entry["closed"]:
        yield "the boundary is not a closed manifold"
        return
    if entry["triangles"] != expected_triangles(entry):
        yield (f"{entry['triangles']:,} triangles, where points, pieces and handles ask for "
               f"{expected_triangles(entry):,}: the counts contradict each other")
    yield "every point is on the surface" if inside == 0 else (
        f"{inside:,} points ({100 * inside / count:.1f} %) are not on the surface, before sculpting "
        f"{entry['inside_before']:,}")
    if entry["components"] != 1:
        yield f"{entry['components']} pieces"
    model = entry["model"]
    if model and model["closed"]:
        same = entry["genus"] == model["genus"] and entry["components"] == model["components"]
        yield f"genus {entry['genus']} like the model's" if same else (
            f"genus {entry['genus']} (pieces: {entry['components']}) where the model has genus {model['genus']} "
            f"(pieces: {model['components']})")
    elif model:
        yield "the model is open, the result closed: what lies over the opening is counted as distance"
    if model:
        yield (f"its distance from the model is {100 * model['mean_distance']:.2g} % of the diagonal in the mean, at "
               f"most {100 * model['largest_distance']:.2g} %")


def about_the_paper(entry, paper):
    """Sentences on how it differs from the paper's line."""
    ours, theirs = entry["tetrahedra"] / distinct(entry), paper.tetrahedra / paper.points
    share, printed = 100 * entry["removed"] / entry["tetrahedra"], 100 * paper.removed / paper.tetrahedra
    if abs(ours / theirs - 1) > 0.1:
        yield f"the first solid has {ours / theirs:.2f} times the paper's tetrahedra per point"
    if abs(share / printed - 1) > 0.1:
        inside = 100 * entry["inside_before"] / distinct(entry)
        yield (f"sculpting removes {share:.1f} % of the first solid, the paper's {printed:.1f} %: {inside:.1f} % of "
               "the points were inside")
    now = seconds(entry, "1") / distinct(entry)
    yield f"per point {60 * paper.minutes / paper.points / now:,.0f} times as fast on one core"


def remark(entry):
    words = f"{entry['file']}: {entry['what']}"
    if entry["failure"] or entry["skipped"]:
        return f"{words}. {'Failed' if entry['failure'] else 'Skipped'}: {entry['failure'] or entry['skipped']}."
    sentences = ["; ".join(about_the_surface(entry))]
    if entry["paper"]:
        sentences.append("; ".join(about_the_paper(entry, PAPER[entry["paper"]])))
    return f"{words}. " + " ".join(text[0].upper() + text[1:] + "." for text in sentences)


def conclusion(entries):
    """What the table says of all of them, computed from it."""
    done = [entry for entry in entries if not entry["failure"] and not entry["skipped"]]
    if not done:
        return "Nothing ran."
    whole = [entry for entry in done if entry["inside"] + entry["uncovered"] == 0]
    worst = max(done, key=lambda entry: seconds(entry, "1") / distinct(entry))
    text = f"Of {len(done)} objects {len(whole)} have every point on the surface"
    left = sorted((entry for entry in done if entry not in whole), key=lambda entry: -entry["alpha"] / entry["spacing"])
    if left:
        text += "; points are left inside " + ", ".join(
            f"{entry['file']} ({entry['inside'] + entry['uncovered']:,}, alpha of "
            f"{entry['alpha'] / entry['spacing']:.0f} spacings)" for entry in left)
    return (f"{text}. The slowest per point is {worst['file']}, with "
            f"{10_000 * seconds(worst, '1') / distinct(worst):.2f} s for 10,000 points on one core.")


def lines(results):
    entries = results["objects"]
    rows = []
    for name in [*PAPER, ""]:
        if name:
            rows.append(printed_line(name))
        rows += [our_line(entry) for entry in entries if entry["paper"] == name]
    text = page.heading("Table 1 of Bernardini et al. 1997 beside ours", results, "bernardini-table-1.json")
    text += [notes(results), "", *page.table(HEADER, rows), ""]
    text += [conclusion(entries), "", f"No file of ours stands for: {', '.join(WITHOUT)}.", ""]
    text += [f"- {remark(entry)}" for entry in entries]
    return text + ["", page.other_load(results["load"])]
