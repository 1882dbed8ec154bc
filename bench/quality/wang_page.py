# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of Wang 2006: its numbers and ours, and a sentence for each difference that matters."""
import math
import statistics

import wang_numbers
from paper_wang import BLOCK_RADII, BLOCK_SIZE, CASES
from tables import page

HEADER = ["object", "points", "bin size", "kept", "of the points", "triangles", "boundary edges", "χ", "pieces",
          "loops", "holes", "handles", "95 % of the scan within, largest (bins)", "beyond borders", "seconds"]

NUMBERS = """\
What the thesis prints of thinning, what formulas say, and what voxel-thin finds with `rule: minimum` and
`guarantee: centres`, which is the thesis's rule: the least bin size that any point's fit of 25 neighbours gives. In
brackets with the origin of the fit at the neighbours' centroid, the thesis's improved rule."""

TABLE = """\
Lines in bold are printed in the thesis, their boundary edges follow from Euler's identity F = 2 V − 2 χ − b if every
point kept is in a triangle and χ is that of what is shown; ours are counted. **Only the hyperboloid is the thesis's
data.** Bins have its size, for scans of another size its share of the diagonal. Distances are from the points of the
whole scan to the mesh, without those that are nearest to its borders, which are counted beside. Seconds are voxel-thin,
region-grow and features, with one thread, and with all after the slash; rounds: {rounds}, the median counts."""


def printed_line(name):
    case = CASES[name]
    return [f"**{case.what}**", f"{case.points:,}", f"{case.bin_size} mm", f"{case.kept:,}",
            f"{100 * case.kept / case.points:.1f} %", f"{case.facets:,}" if case.facets else "not printed",
            f"{case.boundary_edges:,}" if case.facets else "", case.euler, "", "", case.holes, "", "", "", ""]


def seconds(entry):
    return " / ".join(f"{statistics.median(entry['seconds'][threads]):.2f}" for threads in ("1", "all"))


def our_line(entry):
    if entry["failure"] or entry["skipped"]:
        return [entry["file"], *[""] * (len(HEADER) - 2), "failed" if entry["failure"] else "skipped"]
    bins = entry["bin_size"]
    return [entry["file"], f"{entry['points']:,}", f"{bins:.4g}", f"{entry['kept']:,}",
            f"{100 * entry['kept'] / entry['points']:.1f} %", f"{entry['triangles']:,}", f"{entry['boundary_edges']:,}",
            entry["euler"], entry["components"], entry["loops"], entry["holes"],
            "" if entry["genus"] is None else entry["genus"],
            f"{entry['deviation_p95'] / bins:.2f}, {entry['deviation_max'] / bins:.2f}", f"{entry['beyond_borders']:,}",
            seconds(entry)]


def expected_triangles(entry):
    """Euler's identity: 2 V − 2 χ − b."""
    return 2 * entry["vertices"] - 2 * entry["euler"] - entry["boundary_edges"]


def told(loops, genus, pieces):
    return f"loops: {loops}, handles: {'not known' if genus is None else genus}, pieces: {pieces}"


def about_the_mesh(entry):
    if not entry["manifold"]:
        yield "it is not an oriented manifold"
    elif entry["triangles"] == expected_triangles(entry):
        yield f"an oriented manifold with F = 2 V − 2 χ − b = {entry['triangles']:,}"
    else:
        yield (f"{entry['triangles']:,} triangles, where Euler's identity asks for {expected_triangles(entry):,}: the "
               f"counts contradict each other")
    yield "every point kept is in a triangle" if entry["vertices"] == entry["kept"] else (
        f"points kept that are in no triangle: {entry['kept'] - entry['vertices']:,}")
    if entry["self_intersections"]:
        yield f"pairs of triangles that intersect: {entry['self_intersections']:,}"
    if entry.get("model"):
        yield (f"{told(entry['loops'], entry['genus'], entry['components'])}; the mesh that its points are from: "
               f"{told(entry['model']['loops'], entry['model']['genus'], entry['model']['components'])}")


def about_the_thesis(entry):
    case = CASES[entry["case"]]
    if case.facets:
        yield (f"{entry['triangles'] / entry['vertices']:.2f} triangles for each point, the thesis's "
               f"{case.facets / case.kept:.2f}")
    if entry["holes"] != case.holes:
        yield f"holes: {entry['holes']}, where {case.what} shows {case.holes}"


def true_radius(hole):
    return min(BLOCK_RADII, key=lambda radius: abs(radius - hole["mean"]))


def about_the_border(entry):
    """The block's face has a border of known length, and about one edge in a bin of it."""
    x, y, _ = BLOCK_SIZE
    large, small = BLOCK_RADII
    length = 2 * (x + y) + 2 * math.pi * (large + 4 * small)
    yield (f"the border of its face is {length:.0f} long, {length / entry['bin_size']:.0f} bins; the thesis's counts "
           f"leave {CASES['block'].boundary_edges} boundary edges, so its mesh ended elsewhere too, or left points out")


def about_the_radii(entry):
    for hole in entry["radii"]:
        radius = true_radius(hole)
        off = (hole["mean"] - radius) / entry["bin_size"]
        yield (f"a hole of radius {radius} is found with {hole['mean']:.2f} in the mean ({hole['least']:.2f} to "
               f"{hole['largest']:.2f}), {abs(off):.2f} bins {'more' if off > 0 else 'less'}"
               + ("" if abs(off) <= 1 else ", which is more than one bin"))


def remark(entry):
    words = f"{entry['file']}: {entry['what']}"
    if entry["failure"] or entry["skipped"]:
        return f"{words}. {'Failed' if entry['failure'] else 'Skipped'}: {entry['failure'] or entry['skipped']}."
    sentences = ["; ".join(about_the_mesh(entry)), "; ".join(about_the_thesis(entry)),
                 *("; ".join(about(entry)) for about in (about_the_border, about_the_radii) if "radii" in entry)]
    return f"{words}. " + " ".join(text[0].upper() + text[1:] + "." for text in sentences if text)


def conclusion(entries):
    """What the table says of all of them, computed from it."""
    done = [entry for entry in entries if not entry["failure"] and not entry["skipped"]]
    if not done:
        return "Nothing ran."
    sound = [entry for entry in done if entry["manifold"] and entry["triangles"] == expected_triangles(entry)]
    text = f"Of {len(done)} meshes {len(sound)} are oriented manifolds that obey Euler's identity."
    block = next((entry for entry in done if "radii" in entry), None)
    if block:
        off = max((abs(hole["mean"] - true_radius(hole)) for hole in block["radii"]), default=0) / block["bin_size"]
        text += (f" In the block {block['holes']} holes are found, their mean radii within {off:.2f} bins of the true "
                 f"ones.")
    return text


def lines(results):
    entries = results["cases"]
    rows = []
    for name in CASES:
        rows.append(printed_line(name))
        rows += [our_line(entry) for entry in entries if entry["case"] == name]
    text = page.heading("The numbers of Wang 2006 beside ours", results, "wang-tables.json")
    text += ["## Clouds and bin sizes (chapter 3)", "", NUMBERS, "",
             *page.table(wang_numbers.HEADER, wang_numbers.rows(results)), ""]
    text += ["## Cases (section 4.4)", "", TABLE.format(rounds=results["rounds"]), "", *page.table(HEADER, rows), ""]
    text += [conclusion(entries), ""]
    text += [f"- {remark(entry)}" for entry in entries]
    return text + ["", page.other_load(results["load"])]
