# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of sharp_surface.py: creases, patches and tessellations of raw scans, and the goals that they miss."""
from tables import page

MECHANICAL = ["fandisk", "fandisk_large", "anchor_dense", "couplingdown"]
ORGANIC = ["bunny00", "armadillo", "hand", "elephant", "homer"]
#: Models whose dihedral angles along the creases have goals. The edges of fandisk_large are cut off by a row of
#: triangles: its creases turn at nearly every vertex, so most of their length is near a corner.
ANGLES = ["fandisk", "anchor_dense"]
#: Standard deviations of the noise, in percent of the diagonal, at which creases and angles have goals.
CREASE_GOALS = [0.05]
ANGLE_GOALS = [0, 0.05]
#: Two spacings of the dense mesh, in percent of the diagonal: creases within it count as found or true.
DISTANCE = 0.5
#: Largest difference of the dihedral angles, in degrees.
DEGREES = 5

#: The goals.
MOST_LOOSENED = {"mechanical": 0.01, "organic": 0.005}
LARGEST_JUMP = 1e-9
LEAST_FOUND = 0.9
MOST_ELSEWHERE = 0.1
LEAST_RIGHT = 0.9
MOST_MICROSECONDS = 100

NOTES = f"""\
Every model is scanned by `virtual-scan` from 20 views with rays 0.5 % of the diagonal apart and with *noise* along the
rays (standard deviation, in percent of the diagonal), without normals. The workflow
[bernardini-1997-raw](../../workflows/bernardini-1997-raw.yaml) makes the *dense* mesh, the *light* mesh and the smooth
surface of the points, with its default parameters.

**Creases.** *sharp edges* are those that the light mesh declares, true creases those of `features` on the model.
*found* is the share of the true length within {DISTANCE} % of the diagonal, two spacings of the dense mesh, of a sharp
edge; *elsewhere* is the share of the length of the sharp edges that is farther from every true crease.

**Patches.** *loosened* is the number of pointed vertices as a share of the vertices of the light mesh; *straight*,
*refined*, *c1-jump*, *inverted* and *signs* (`sign-violations`) are metrics of `a-patch`. *µs* is the processor time of
`a-patch` per triangle of the light mesh: without points on one thread (the faster of two runs), and with the points.

**Tessellation.** *cuts* counts pairs of intersecting triangles. *rms* is the distance of samples on a mesh from the
model, in percent of the diagonal (`rms-to-truth` of `measure`). The columns from *length* to *error* compare dihedral
angles along the true creases, without the parts within a median edge of the light mesh from a true corner: *length* is
what remains, in diagonals. *near* is its share within {DISTANCE} % of the diagonal of a crease of the tessellation. The
dihedral angle is that between the normals at an eighth of that edge left and right of the true crease, and of the
nearest crease of the tessellation. *angles* is the share of the length where a crease is near and both angles differ by
at most {DEGREES}°; *error* is the median difference where a crease is near, in degrees. The edges of fandisk_large are
cut off by a row of triangles, and its creases turn at nearly every vertex; fandisk is the same shape with exact edges.

**Goals.** loosened at most {100 * MOST_LOOSENED["mechanical"]:g} %, on organic models
{100 * MOST_LOOSENED["organic"]:g} %; c1-jump below {LARGEST_JUMP:g}; closed; no cuts; rms of the tessellation at most
that of the light mesh; less than {MOST_MICROSECONDS} µs without points. On {", ".join(MECHANICAL)}
with a noise of {" and ".join(f"{noise:g} %" for noise in CREASE_GOALS)}: found at least {100 * LEAST_FOUND:g} %,
elsewhere at most {100 * MOST_ELSEWHERE:g} %. On {" and ".join(ANGLES)} with a noise of
{" and ".join(f"{noise:g} %" for noise in ANGLE_GOALS)}: angles at least {100 * LEAST_RIGHT:g} %."""


def percent(value, digits=1):
    return "none" if value is None else f"{100 * value:.{digits}f} %"


def misses(record):
    """The goals that a case misses, as words with the value."""
    found = [record["error"]] if record.get("error") else []
    name, noise = record["name"], record["noise"]

    def take(part, key, is_right, text):
        """A part that is absent has an error already."""
        if part in record and not is_right(record[part][key]):
            found.append(text(record[part][key]))

    if name in MECHANICAL and noise in CREASE_GOALS:
        take("creases", "found", lambda share: share is not None and share >= LEAST_FOUND,
             lambda share: f"{percent(share)} of the creases found")
        take("creases", "false", lambda share: share <= MOST_ELSEWHERE, lambda share: f"{percent(share)} elsewhere")
    most = MOST_LOOSENED["mechanical" if name in MECHANICAL else "organic"]
    take("patches", "loosened", lambda share: share <= most, lambda share: f"{percent(share, 2)} loosened")
    take("patches", "c1-jump", lambda jump: jump < LARGEST_JUMP, lambda jump: f"c1-jump {jump:.0e}")
    take("alone", "microseconds", lambda time: time < MOST_MICROSECONDS, lambda time: f"{time:.0f} µs without points")
    take("smooth", "closed", lambda closed: closed, lambda closed: "not closed")
    take("smooth", "cuts", lambda count: count == 0, lambda count: f"{count} cuts")
    if "light" in record:
        take("smooth", "rms", lambda rms: rms <= record["light"]["rms"],
             lambda rms: f"rms {rms:.3g} % above {record['light']['rms']:.3g} %")
    if name in ANGLES and noise in ANGLE_GOALS:
        take("angles", "right", lambda share: share is not None and share >= LEAST_RIGHT,
             lambda share: f"{percent(share)} of the angles")
    return found


def cells_of(record, part, texts):
    """The cells of one part, empty if the case has none."""
    if part not in record:
        return [""] * len(texts)
    return [text(record[part][key]) for key, text in texts.items()]


def count(value):
    return f"{value:,}"


def table_of(records, columns):
    """A table of parts: (name of the part, {key: text}) by column heading."""
    header = ["model", "noise", *(heading for headings, _, _ in columns for heading in headings)]
    return page.table(header, [
        [record["name"], f"{record['noise']:g}",
         *(cell for _, part, texts in columns for cell in cells_of(record, part, texts))] for record in records])


def lines_of(results):
    records = results["records"]
    three = lambda value: f"{value:.3g}"  # noqa: E731
    yes = lambda value: "yes" if value else "no"  # noqa: E731
    lines = [*page.heading("Smooth surfaces with creases of raw scans", results, "sharp-surface.json"), NOTES, ""]
    lines += ["## Creases", "", *table_of(records, [
        (["dense", "light"], "triangles", {"dense": count, "light": count}),
        (["sharp edges", "found", "elsewhere"], "creases", {"edges": count, "found": percent, "false": percent})]), ""]
    lines += ["## Patches", "", *table_of(records, [
        (["loosened", "straight", "refined", "c1-jump", "inverted", "signs"], "patches",
         {"loosened": lambda share: percent(share, 2), "straight-edges": count, "refined": count,
          "c1-jump": lambda jump: f"{jump:.0e}", "inverted": count, "sign-violations": count}),
        (["µs without points"], "alone", {"microseconds": lambda time: f"{time:.0f}"}),
        (["µs with points"], "patches", {"microseconds": lambda time: f"{time:.0f}"})]), ""]
    lines += ["## Tessellation", "", *table_of(records, [
        (["triangles", "closed", "pieces", "cuts"], "smooth",
         {"triangles": count, "closed": yes, "pieces": count, "cuts": count}),
        (["rms of light"], "light", {"rms": three}), (["rms"], "smooth", {"rms": three}),
        (["length", "near", "angles", "error"], "angles",
         {"length": three, "near": percent, "right": percent,
          "error": lambda error: "" if error is None else three(error)}),
        (["CPU seconds, whole", "outcome"], "run", {"seconds": lambda time: f"{time:.0f}", "outcome": str})]), ""]
    missed = [(record, found) for record in records if (found := misses(record))]
    lines += ["## Goals", "", f"{len(records) - len(missed)} of {len(records)} cases reach all goals.", ""]
    lines += [f"- {record['name']}, noise {record['noise']:g} %: {'; '.join(found)}" for record, found in missed]
    return [*lines, "", page.other_load(results["load"])]
