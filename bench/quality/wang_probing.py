# SPDX-License-Identifier: GPL-3.0-or-later
"""The ranges of approaches in tables 5.1 and 5.2 of Wang 2006: printed, by equation 5.7, and planned by us.

The tables give directions in a plane through the axis, in degrees from the axis: 90 is perpendicular to it, and of the
cone on the hemisphere 180 is along the axis towards the cone.
"""
import json
import math
import pathlib
import statistics

import paper_wang as paper
from tables import scanmill

HEADER = ["table", "body", "height, radius", "thesis: range", "centre", "half", "equation 5.7: centre", "half", "range",
          "Scanmill, from a scan: interior angle (true)", "centre", "half", "touches: with a range / all / expected"]
#: A measured interior angle that is further off, in degrees, is remarked on.
NEAR = 1

RESOLUTION, BIN_SIZE = 0.25, 1
#: Between touches, as in wang-probing.yaml.
SPACING = 10
VIEWS = "[" + ", ".join(f"{x}, {y}, {z}" for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)) + "]"


def interior_angle(case):
    """Between the two faces at the edge, in degrees."""
    slope = math.degrees(math.atan(case.height / case.radius))
    return 2 * slope if case.shape == "bicone" else 90 + slope


def centre(case):
    """Of the range: the bisector of the faces' normals, in degrees from the axis."""
    if case.shape == "bicone":
        return 90.0
    return 90 + (90 - math.degrees(math.atan(case.height / case.radius))) / 2


def half_range(case):
    """Equation 5.7: acos(t / r) - alpha / 2, in degrees."""
    return math.degrees(math.acos(paper.REFERENCE_ERROR / paper.PROBE_RADIUS)) - interior_angle(case) / 2


def expected_touches(case):
    """On the circular edge."""
    return round(2 * math.pi * case.radius / SPACING)


def in_the_tables_angle(direction):
    """The angle between a direction and the axis as the tables count it, in degrees."""
    return 180 - math.degrees(math.acos(max(-1.0, min(1.0, direction[2] / math.hypot(*direction)))))


def planned(plan):
    """Medians over the touches of a plan (its JSON) that have a range and know both faces: interior angle, centre and
    half of the range, in degrees. `ranges` is their number, `touches` that of all."""
    made = [touch for touch in plan["touches"] if touch["phi-max"] is not None and not touch["assumed"]]
    if not made:
        raise scanmill.Broken("the plan has no touch with a range")
    bisectors = [[a + b for a, b in zip(touch["left-normal"], touch["right-normal"])] for touch in made]
    return {
        "touches": len(plan["touches"]),
        "ranges": len(made),
        "interior_angle": math.degrees(statistics.median(touch["interior-angle"] for touch in made)),
        "centre": statistics.median(in_the_tables_angle(bisector) for bisector in bisectors),
        "half": math.degrees(statistics.median((touch["phi-max"] - touch["phi-min"]) / 2 for touch in made)),
    }


def plan_of(cell):
    """The plan that the cell wrote as JSON."""
    for output in cell["outputs"]:
        if output["kind"] == "probes" and output["outcome"] == "ok" and output["file"].endswith(".json"):
            with open(output["file"]) as file:
                return json.load(file)
    raise scanmill.Broken(f"{cell.get('error') or 'the workflow wrote no probes as JSON'}")


def run(options, folder):
    """Plans the touches of every body from a virtual scan of it; an entry per line of the tables."""
    entries = []
    for place, case in enumerate(paper.PROBING):
        settings = {"shape": case.shape, "size": f"[{case.radius} u, {case.height} u]", "views": VIEWS,
                    "resolution": f"{RESOLUTION} u", "bin-size": f"{BIN_SIZE} u",
                    "radius": f"{paper.PROBE_RADIUS} u", "scanner-error": f"{paper.REFERENCE_ERROR} u"}
        report = scanmill.run(options.program, pathlib.Path(__file__).with_name("wang-probing.yaml"), [],
                              folder / f"probing-{place}", options.limit, settings=settings)
        entries.append({"table": case.table, "height": case.height, "radius": case.radius,
                        **planned(plan_of(report["cells"][0]))})
    return entries


def row(case, entry):
    formula, half = centre(case), half_range(case)
    return [case.table, case.shape, f"{case.height}, {case.radius}", f"{case.low:g} to {case.high:g}",
            f"{case.centre:.2f}", f"{case.half:.2f}", f"{formula:.2f}", f"{half:.2f}",
            f"{formula - half:.2f} to {formula + half:.2f}",
            f"{entry['interior_angle']:.1f} ({interior_angle(case):.1f})", f"{entry['centre']:.1f}",
            f"{entry['half']:.1f}", f"{entry['ranges']} / {entry['touches']} / {expected_touches(case)}"]


def rows(entries):
    return [row(case, entry) for case, entry in zip(paper.PROBING, entries)]


def ratio_that_explains(cases):
    """The least and the largest t / r with which equation 5.7 gives the printed half ranges."""
    ratios = [math.cos(math.radians(case.half + interior_angle(case) / 2)) for case in cases]
    return min(ratios), max(ratios)


def about_the_mesh(entries):
    """Where the angle of the mesh's edge is that of the body."""
    far = [(case, entry) for case, entry in zip(paper.PROBING, entries)
           if abs(entry["interior_angle"] - interior_angle(case)) > NEAR]
    text = (f"Scanmill's half ranges are those of the equation for the angle that the mesh has. It is within {NEAR} "
            f"degree of the true one in {len(entries) - len(far)} of {len(entries)} cases")
    names = ", ".join(f"{interior_angle(case):.0f} ({entry['interior_angle']:.0f})" for case, entry in far)
    return text + (f"; edges of {names} degrees are blunted by triangles across the edge, so fewer directions are "
                   f"planned than are safe." if far else ".")


def about_the_touches(entries):
    """Rows with few touches that have a range."""
    few = [(case, entry) for case, entry in zip(paper.PROBING, entries)
           if entry["ranges"] < expected_touches(case) / 2]
    return [f"**Few touches**: {case.height}, {case.radius} of table {case.table} has a range at {entry['ranges']} of "
            f"{entry['touches']} touches; the edge's length gives {expected_touches(case)}. An interior angle of "
            f"{interior_angle(case):.0f} degrees is found as a sharp edge only in parts of the mesh, so the medians are of "
            f"few touches." for case, entry in few]


def remarks(entries):
    """What agrees and what does not, with numbers."""
    apart = [abs(case.centre - centre(case)) for case in paper.PROBING]
    near = [case for case, off in zip(paper.PROBING, apart) if off <= 0.55]
    others = [case for case in paper.PROBING if case not in near]
    short = [half_range(case) - case.half for case in paper.PROBING]
    least, largest = ratio_that_explains(paper.PROBING)
    stated = paper.REFERENCE_ERROR / paper.PROBE_RADIUS
    names = " and ".join(f"{case.height}, {case.radius} of table {case.table}" for case in others)
    return [
        f"**The centres agree**: {len(near)} of {len(apart)} within 0.55 degrees"
        + (f"; not {names}, which prints {others[0].centre:.1f} instead of {centre(others[0]):.1f}."
           if others else "."),
        f"**The half ranges do not**: the printed ones are {min(short):.1f} to {max(short):.1f} degrees smaller than "
        f"those of the thesis's own equation 5.7 with the stated radius of {paper.PROBE_RADIUS} and reference error of "
        f"{paper.REFERENCE_ERROR}. The equation gives them with t / r from {least:.3f} to {largest:.3f} instead of "
        f"{stated:.2f}. Scanmill follows the equation, which a simulation of the moving ball confirms.",
        about_the_mesh(entries),
        *about_the_touches(entries),
    ]
