# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of Wang 2006: its numbers, our numbers, and remarks on relevant differences."""
import math
import statistics

import paper_wang as paper
import wang_numbers
import wang_probing
from paper_wang import BLOCK_RADII, BLOCK_SIZE, CASES
from tables import page

HEADER = ["object", "points", "voxel size", "kept", "share", "triangles", "boundary edges", "χ", "components", "loops",
          "holes", "handles", "distance p95, largest (voxel edges)", "beyond the boundary", "seconds"]

NUMBERS = """\
The table compares the thesis's numbers on thinning with closed forms and with voxel-thin. voxel-thin runs with
`rule: minimum` and `guarantee: centres`, which is the thesis's rule: the least voxel size over all points, each with a
fit to 25 neighbours. Numbers in brackets use the neighbours' centroid as the origin of the fit, the thesis's improved
rule."""

TABLE = """\
Lines in bold are printed in the thesis. Their boundary edges follow from Euler's identity F = 2 V − 2 χ − b, if every
kept point is in a triangle and χ is that of the depicted object. Our boundary edges are counted. **Only the hyperboloid
is the thesis's data.** Our voxels have the thesis's size; for a scan of another size, the same share of the diagonal.
Distances are from all points of the scan to the mesh, without the points nearest to its boundary, which are counted
separately. Seconds are those of voxel-thin, region-grow and features, with one thread and, after the slash, with all
threads (median of {rounds} rounds)."""


PROBING = """\
Table 5.1 has two cones with a common base, table 5.2 a cone on half of a sphere: each has one circular edge of a known
angle. The ranges are those of directions from which a ball of radius {radius} meets the edge before a face, wherever the
reference point is within {error} of the edge, in degrees from the axis. Scanmill's columns are medians over the touches
that probe-planner plans from a virtual scan, thinned and triangulated, as far as the mesh has both faces there; the
interior angle is measured on the mesh. The scan has eight views, one from each octant, with rays {resolution} apart; the
voxels have an edge of {bin_size}. Touches are 10 apart, and may be tilted by up to 180 degrees (`spacing: 10 u`,
`max-tilt: 180 deg`). All other settings are the defaults (wang-probing.yaml). Touches with a range are those that have
a range for every reference point within the error, and both faces in the mesh; expected are the length of the edge
divided by the spacing. All touches contain those at the tips of cones, which are blunt in a mesh."""


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


def topology_text(loops, genus, pieces):
    return f"loops: {loops}, handles: {'unknown' if genus is None else genus}, components: {pieces}"


def about_the_mesh(entry):
    if not entry["manifold"]:
        yield "the mesh is not an oriented manifold"
    elif entry["triangles"] == expected_triangles(entry):
        yield f"an oriented manifold with F = 2 V − 2 χ − b = {entry['triangles']:,}"
    else:
        yield (f"{entry['triangles']:,} triangles, but Euler's identity gives {expected_triangles(entry):,}: the "
               f"counts contradict each other")
    yield "every kept point is in a triangle" if entry["vertices"] == entry["kept"] else (
        f"kept points in no triangle: {entry['kept'] - entry['vertices']:,}")
    if entry["self_intersections"]:
        yield f"pairs of intersecting triangles: {entry['self_intersections']:,}"
    if entry.get("model"):
        yield (f"{topology_text(entry['loops'], entry['genus'], entry['components'])}; in the mesh that the points come from: "
               f"{topology_text(entry['model']['loops'], entry['model']['genus'], entry['model']['components'])}")


def about_the_thesis(entry):
    case = CASES[entry["case"]]
    if case.facets:
        yield (f"triangles per point: {entry['triangles'] / entry['vertices']:.2f}, in the thesis "
               f"{case.facets / case.kept:.2f}")
    if entry["holes"] != case.holes:
        yield f"holes: {entry['holes']} instead of {case.holes}"


def true_radius(hole):
    return min(BLOCK_RADII, key=lambda radius: abs(radius - hole["mean"]))


def about_the_border(entry):
    """Compares the known length of the boundary of the block's face with the thesis's number of boundary edges."""
    x, y, _ = BLOCK_SIZE
    large, small = BLOCK_RADII
    length = 2 * (x + y) + 2 * math.pi * (large + 4 * small)
    yield (f"the boundary of its face has a length of {length:.0f}, or {length / entry['bin_size']:.0f} voxel edges; "
           f"the thesis's counts imply {CASES['block'].boundary_edges} boundary edges, so its mesh had further "
           f"boundaries or unused points")


def about_the_radii(entry):
    for hole in entry["radii"]:
        radius = true_radius(hole)
        off = (hole["mean"] - radius) / entry["bin_size"]
        yield (f"hole of radius {radius}: mean radius {hole['mean']:.2f} ({hole['least']:.2f} to "
               f"{hole['largest']:.2f}), {abs(off):.2f} voxel edges too {'large' if off > 0 else 'small'}"
               + ("" if abs(off) <= 1 else ", which is more than one voxel"))


def remark(entry):
    words = f"{entry['file']}: {entry['what']}"
    if entry["failure"] or entry["skipped"]:
        return f"{words}. {'Failed' if entry['failure'] else 'Skipped'}: {entry['failure'] or entry['skipped']}."
    sentences = ["; ".join(about_the_mesh(entry)), "; ".join(about_the_thesis(entry)),
                 *("; ".join(about(entry)) for about in (about_the_border, about_the_radii) if "radii" in entry)]
    return f"{words}. " + " ".join(text[0].upper() + text[1:] + "." for text in sentences if text)


def conclusion(entries):
    """A summary of all entries."""
    done = [entry for entry in entries if not entry["failure"] and not entry["skipped"]]
    if not done:
        return "Nothing ran."
    sound = [entry for entry in done if entry["manifold"] and entry["triangles"] == expected_triangles(entry)]
    text = f"{len(sound)} of {len(done)} meshes are oriented manifolds that satisfy Euler's identity."
    block = next((entry for entry in done if "radii" in entry), None)
    if block:
        off = max((abs(hole["mean"] - true_radius(hole)) for hole in block["radii"]), default=0) / block["bin_size"]
        text += (f" In the block {block['holes']} holes are found; their mean radii differ from the true ones by at "
                 f"most {off:.2f} voxel edges.")
    return text


def lines(results):
    entries = results["cases"]
    rows = []
    for name in CASES:
        rows.append(printed_line(name))
        rows += [our_line(entry) for entry in entries if entry["case"] == name]
    text = page.heading("The numbers of Wang 2006, compared with Scanmill", results, "wang-tables.json")
    text += ["## Clouds and voxel sizes (chapter 3)", "", NUMBERS, "",
             *page.table(wang_numbers.HEADER, wang_numbers.rows(results)), ""]
    text += ["## Cases (section 4.4)", "", TABLE.format(rounds=results["rounds"]), "", *page.table(HEADER, rows), ""]
    text += [conclusion(entries), ""]
    text += [f"- {remark(entry)}" for entry in entries]
    text += ["", "## Directions of the probe (chapter 5)", "",
             PROBING.format(radius=paper.PROBE_RADIUS, error=paper.REFERENCE_ERROR,
                            resolution=wang_probing.RESOLUTION, bin_size=wang_probing.BIN_SIZE), "",
             *page.table(wang_probing.HEADER, wang_probing.rows(results["probing"])), ""]
    text += [f"- {sentence}" for sentence in wang_probing.remarks(results["probing"])]
    return text + ["", page.other_load(results["load"])]
