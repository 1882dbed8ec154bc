# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of wang_hybrid.py."""
from tables import page

NOTES = """\
The thesis ends with the plan: it proposes to measure the edges of a part that was scanned, and to validate that. Here the
whole way is run on parts whose true edges are known:

1. A virtual scan of the part: ten views, rays {resolution:g} mm apart, noise {noise:g} mm, {outliers} outliers. The models are
   scaled to a diagonal of 135 mm.
2. [wang-2006-hybrid.yaml](../../workflows/wang-2006-hybrid.yaml): clean, thin to voxels of {bin_size:g} mm, find edges, move into
   the machine's frame by the four corners of the base plate, plan touches every {spacing:g} mm from two directions with a ball of
   radius {radius:g} mm, write the plan as DMIS. Only creases are planned: the parts are closed, so boundaries of their meshes are
   holes in the scan, and touches there find no edge.
3. A simulated machine reads the DMIS program, moves the ball along each approach until it meets the true part, adds an error
   of {machine_noise:g} mm in each coordinate, and writes its results as DMIS.
4. [scan-and-touches.yaml](../../workflows/scan-and-touches.yaml) makes one mesh of the scan and these results. *Scan alone* is
   the mesh of the same voxels without touches.

Edges that face down, where the part lies, cannot be touched from above, and concave ones by no ball: they stay as scanned.
"""

EDGES = """\
*Planned* is the length of the lines between neighbouring touches that the machine makes; where both have two directions, the
touches fix the edge (*pairs*), elsewhere they measure it along one direction only (*singles*). Distances are from the true edge
to the nearest crease of the mesh, along the planned lines, in mm. *Probe's error* is three standard deviations of a pair and the
allowed error of the chords between touches. The round edges of *fandisk*, *anchor_dense* and *joint* are polygons, and the lines between touches are
arcs: they differ by the height of an arc over a side. *fandisk_large* has no sharp edges: its triangles lead across them, over up to
0.9 mm at this size, so there the distance says how far the creases are from such triangles' sides.
"""

SURFACES = """\
Distances of the whole mesh from the part, in both directions, in mm (mean and 95 %), and the length of creases that are more than
{near:g} mm from every true edge. *Minutes* are those of the machine by a stated model: moves at 100 mm/s and 0.3 s for each stop,
approaches at 8 mm/s there and back, 0.5 s for each touch. *All by touch* is the time for as many touches as the mesh has
vertices, at the same mean time.
"""


def shown(value, digits=3):
    return "–" if value is None else f"{value:.{digits}f}"


def edge_row(case):
    alone, hybrid = case["alone"]["edge"], case["hybrid"]["edge"]
    pairs, singles = hybrid["pairs"] or {}, hybrid["singles"] or {}
    before = alone["pairs"] or {}
    return [case["part"], f"{case['true_length']:.0f}", f"{pairs.get('length', 0):.0f}, {singles.get('length', 0):.0f}",
            f"{shown(before.get('mean'))}, {shown(before.get('p99'))}", f"{shown(pairs.get('mean'))}, {shown(pairs.get('p99'))}",
            shown(case["bound"]) if pairs else "–", "–" if hybrid["within"] is None else f"{100 * hybrid['within']:.1f} %",
            f"{shown((alone['singles'] or {}).get('p95'))} → {shown(singles.get('p95'))}"]


def surface_row(case):
    plan, alone, hybrid = case["plan_metrics"], case["alone"], case["hybrid"]
    minutes = case["seconds_on_machine"] / 60
    return [case["part"], f"{case['touched']:,}", f"{plan['unreachable']:,.0f}", f"{minutes:.0f}",
            f"{minutes / 60 * alone['vertices'] / max(1, case['touched']):.0f} h",
            f"{shown(alone['mean'], 4)}, {shown(alone['p95'], 4)}", f"{shown(hybrid['mean'], 4)}, {shown(hybrid['p95'], 4)}",
            f"{alone['false']:.0f} → {hybrid['false']:.0f}"]


def lines(results):
    found = page.heading("Wang 2006, chapter 6: scanned faces and touched edges in one model", results,
                         "bench/quality/wang_hybrid.py")
    cases = [case for case in results["cases"] if not case["failure"]]
    found += NOTES.format(**results["settings"]).splitlines() + ["", "## Edges", "", *EDGES.splitlines(), ""]
    found += page.table(["part", "true edges", "planned: pairs, singles", "scan alone, pairs: mean, 99 %",
                         "with touches: mean, 99 %", "probe's error", "within it", "singles, 95 %: alone → with"],
                        [edge_row(case) for case in cases])
    found += ["", "## Surfaces and time", "", *SURFACES.format(**results["settings"]).splitlines(), ""]
    found += page.table(["part", "touches", "not reachable", "minutes", "all by touch", "scan alone: mean, 95 %",
                         "with touches: mean, 95 %", "false creases"], [surface_row(case) for case in cases])
    for case in results["cases"]:
        if case["failure"]:
            found += ["", f"{case['part']}: {case['failure']}"]
    return found + ["", page.other_load(results["load"])]
