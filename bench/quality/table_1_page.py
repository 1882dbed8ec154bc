# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of Table 1: the paper's lines, our lines, and remarks on relevant differences."""
import statistics

from paper_table_1 import MACHINE, PAPER, WITHOUT
from tables import page

HEADER = ["object", "points n", "time", "tetrahedra of the alpha-solid", "per point", "removed", "share", "triangles",
          "triangles − (2n − 4)", "points left inside", "genus", "alpha / spacing"]

NOTES = """\
Lines in bold are printed in the paper ({machine}). Their times are minutes for the whole
method: tetrahedralisation, alpha-shapes, choice of alpha, sculpting. The lines below them are our objects of the same
kind. **None of our objects is the paper's data**, which is not published. Compare shares and counts per point, not
totals. Our times are the seconds of delaunay, alpha-solid and sculpt, with one thread and, after the slash, with all
threads (median of {rounds} rounds). They do not include reading and writing files.

A closed surface of genus 0 through all n points has 2n − 4 triangles. Every point left inside removes 2 triangles,
every handle adds 4, and every connected component beyond the first removes 4. The paper gives neither the points left
inside nor the genus; {exact} of its {objects} lines have exactly 2n − 4. The last column is alpha divided by the
spacing, which is the median distance to the nearest point or the median edge of a mesh. Evenly sampled surfaces need
about 1."""


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
    """From points on the surface, components and genus: 2 V − 4 C + 4 G."""
    on_surface = distinct(entry) - entry["inside"] - entry["uncovered"]
    return 2 * on_surface - 4 * entry["components"] + 4 * entry["genus"]


def about_the_surface(entry):
    """Remarks on the correctness of the surface."""
    count, inside = distinct(entry), entry["inside"] + entry["uncovered"]
    if not entry["closed"]:
        yield "the boundary is not a closed manifold"
        return
    if entry["triangles"] != expected_triangles(entry):
        yield (f"{entry['triangles']:,} triangles, but points, components and genus give "
               f"{expected_triangles(entry):,}: the counts contradict each other")
    yield "every point is on the surface" if inside == 0 else (
        f"points not on the surface: {inside:,} ({100 * inside / count:.1f} %), before sculpting "
        f"{entry['inside_before']:,}")
    if entry["components"] != 1:
        yield f"connected components: {entry['components']}"
    model = entry["model"]
    if model and model["closed"]:
        same = entry["genus"] == model["genus"] and entry["components"] == model["components"]
        yield f"genus {entry['genus']}, as the model" if same else (
            f"genus {entry['genus']} (components: {entry['components']}), but the model has genus {model['genus']} "
            f"(components: {model['components']})")
    elif model:
        yield "the model is open and the result is closed, so the part over the opening adds to the distance"
    if model:
        yield (f"distance from the model: mean {100 * model['mean_distance']:.2g} % of the diagonal, largest "
               f"{100 * model['largest_distance']:.2g} %")


def about_the_paper(entry, paper):
    """Remarks on differences from the paper's line."""
    ours, theirs = entry["tetrahedra"] / distinct(entry), paper.tetrahedra / paper.points
    share, printed = 100 * entry["removed"] / entry["tetrahedra"], 100 * paper.removed / paper.tetrahedra
    if abs(ours / theirs - 1) > 0.1:
        yield f"the alpha-solid has {ours / theirs:.2f} times the paper's tetrahedra per point"
    if abs(share / printed - 1) > 0.1:
        inside = 100 * entry["inside_before"] / distinct(entry)
        yield (f"sculpting removes {share:.1f} % of the alpha-solid's tetrahedra, in the paper {printed:.1f} %; "
               f"{inside:.1f} % of the points were inside before")
    now = seconds(entry, "1") / distinct(entry)
    yield f"per point, our run is {60 * paper.minutes / paper.points / now:,.0f} times as fast on one core"


def remark(entry):
    words = f"{entry['file']}: {entry['what']}"
    if entry["failure"] or entry["skipped"]:
        return f"{words}. {'Failed' if entry['failure'] else 'Skipped'}: {entry['failure'] or entry['skipped']}."
    sentences = ["; ".join(about_the_surface(entry))]
    if entry["paper"]:
        sentences.append("; ".join(about_the_paper(entry, PAPER[entry["paper"]])))
    return f"{words}. " + " ".join(text[0].upper() + text[1:] + "." for text in sentences)


def conclusion(entries):
    """A summary of all entries."""
    done = [entry for entry in entries if not entry["failure"] and not entry["skipped"]]
    if not done:
        return "Nothing ran."
    whole = [entry for entry in done if entry["inside"] + entry["uncovered"] == 0]
    worst = max(done, key=lambda entry: seconds(entry, "1") / distinct(entry))
    text = f"In {len(whole)} of {len(done)} objects every point is on the surface"
    left = sorted((entry for entry in done if entry not in whole), key=lambda entry: -entry["alpha"] / entry["spacing"])
    if left:
        text += ". Points are left inside the solid in " + ", ".join(
            f"{entry['file']} (points: {entry['inside'] + entry['uncovered']:,}, alpha: "
            f"{entry['alpha'] / entry['spacing']:.0f} spacings)" for entry in left)
    return (f"{text}. The slowest object per point is {worst['file']}, with "
            f"{10_000 * seconds(worst, '1') / distinct(worst):.2f} s per 10,000 points on one core.")


def lines(results):
    entries = results["objects"]
    rows = []
    for name in [*PAPER, ""]:
        if name:
            rows.append(printed_line(name))
        rows += [our_line(entry) for entry in entries if entry["paper"] == name]
    text = page.heading("Table 1 of Bernardini et al. 1997, compared with Scanmill", results, "bernardini-table-1.json")
    text += [notes(results), "", *page.table(HEADER, rows), ""]
    text += [conclusion(entries), "", f"Objects of the paper without a similar file: {', '.join(WITHOUT)}.", ""]
    text += [f"- {remark(entry)}" for entry in entries]
    return text + ["", page.other_load(results["load"])]
