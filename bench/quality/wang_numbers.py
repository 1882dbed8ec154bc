# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers of chapter 3 and of the clouds given by formulas: the thesis's, those of formulas, and ours."""
import math

import paper_wang as paper
import wang_clouds as clouds

HEADER = ["section", "what", "thesis", "by formula", "Scanmill", "why they differ"]


def sampling_rows(results):
    count, printed = results["points"], paper.COUNTS
    degrees = math.degrees(clouds.step_of(1, 0.005))
    more = [printed[name] / count[name] - 1 for name in ("hemisphere-1", "hemisphere-8-coarse", "hemisphere-8")]
    why = (f"ours rounds circles and the points on each up, so that no step is too wide; the thesis, which does not "
           f"say how it rounds, has {100 * min(more):.1f} to {100 * max(more):.1f} % more")
    yield ["3.6.1", "hemisphere, radius 1, tolerance 0.005: step", f"{paper.STEP_DEGREES}°", f"{degrees:.3f}°", "",
           "they do not: 2 acos(1 − tolerance / radius)"]
    for name, what in (("hemisphere-1", "radius 1, tolerance 0.005"),
                       ("hemisphere-8-coarse", "radius 8, tolerance 0.025"),
                       ("hemisphere-8", "radius 8, tolerance 0.005")):
        yield ["3.6.1", f"hemisphere, {what}: points", f"{printed[name]:,}", f"{count[name]:,}", "", why]
        why = "as above"


def kept_text(thinning):
    return " / ".join(f"{thinning[f'{how}, nearest']['kept']:,}" for how in ("exact", "thesis"))


def bin_text(thinning, derivatives):
    nearest, centroid = (thinning[f"{derivatives}, {origin}"]["bin_size"] for origin in ("nearest", "centroid"))
    return f"{nearest:.4f} ({centroid:.4f})"


def hemisphere_rows(results):
    line, thinning = paper.HEMISPHERE, results["thinning"]["hemisphere-8"]
    bending = 2 / 8  # of a sphere: both principal curvatures are 1 / r
    exact, halved = (clouds.bin_size(part, line.tolerance) for part in (bending, bending / 2))
    yield [line.section, "hemisphere, radius 8, tolerance 0.025: bin size", line.bin_size, f"{exact:.4f}",
           bin_text(thinning, "exact"),
           f"1.2 asks for second derivatives of {clouds.bending_of(line.bin_size, line.tolerance):.4f} in sum, where a "
           f"sphere of radius 8 has {bending}; points near the rim have neighbours on one side only"]
    yield ["", "the same, with the coefficients a, b, c for the second derivatives 2 a, b, 2 c, as equation 3.9 has it",
           "", f"{halved:.4f}", bin_text(thinning, "thesis"),
           f"that makes bins √2 as large; 1.2 is near the edge Ω = √3 B = {math.sqrt(3) * halved:.3f} that belongs to "
           f"them"]
    binning = results["binning"]["hemisphere-8"]
    yield ["", "points kept, by these two bin sizes", line.kept, "", kept_text(thinning),
           f"bins of the printed 1.2 keep {binning['kept']:,}, and 223 are kept by bins of {binning['bin_size']:.2f}"]


def cone_rows(results):
    line, thinning = paper.CONE, results["thinning"]["cone"]
    within = sum(x * x + y * y < 1 - 1e-9 for x, y, _ in clouds.cone())
    ours = clouds.bending_of(thinning["exact, nearest"]["bin_size"], line.tolerance)
    yield [line.section, "cone, radius and height 1, step 0.05: points", f"{paper.COUNTS['cone']:,}",
           f"{results['points']['cone']:,}", "",
           f"the formula counts the rim; without it there are {within:,}, and rounding decides between"]
    yield ["", "largest curvature", paper.CONE_CURVATURE, "∞", f"{ours:.2f}",
           "at the apex there is none: what a fit finds there depends on the neighbours and on weights; ours is the "
           "sum of the second derivatives behind the bin size"]
    yield ["", "bin size at a tolerance of 0.02", line.bin_size,
           f"{clouds.bin_size(paper.CONE_CURVATURE, line.tolerance):.4f} from 15.25", bin_text(thinning, "exact"),
           f"0.103 asks for {clouds.bending_of(line.bin_size, line.tolerance):.2f}, a third of the curvature printed "
           f"beside it; with a, b, c for derivatives ours is {bin_text(thinning, 'thesis')}"]


def hyperboloid_rows(results):
    line, thinning = paper.HYPERBOLOID, results["thinning"]["hyperboloid"]
    curvatures = [clouds.hyperboloid_curvatures(point) for point in clouds.hyperboloid()]
    largest, both = max(pair[0] for pair in curvatures), max(sum(pair) for pair in curvatures)
    ours = clouds.bending_of(thinning["exact, nearest"]["bin_size"], line.tolerance)
    yield [line.section, "hyperboloid, r = 2, h = 3, step 0.04: points", f"{paper.COUNTS['hyperboloid']:,}",
           f"{results['points']['hyperboloid']:,}", "", "as with the cone: it depends on which points of the rim count"]
    yield ["", "largest curvature", paper.HYPERBOLOID_CURVATURE, f"{largest:.3f}; both together {both:.3f}",
           f"both together {ours:.3f}",
           "the printed number is near the sum of the two principal curvatures on the rim, at y = ± r; fits there have "
           "neighbours on one side only"]
    yield ["", "bin size", line.bin_size, f"at a tolerance of {line.bin_size**2 * both * 3 / 8:.4f}", "",
           "the thesis does not print the tolerance: this is the one that gives 0.21"]
    binning = results["binning"]["hyperboloid"]
    yield ["", "points kept by bins of 0.21", line.kept, "", f"{binning['kept']:,}",
           f"every bin that holds a point keeps one; 707 are kept by bins of {binning['bin_size']:.3f}"]


def nose_row():
    bending = clouds.bending_of(paper.NOSE_BIN, paper.NOSE_TOLERANCE)
    return ["4.4.2", "second derivatives at the nose, from tolerance 0.6 and bins of 1.2 (per mm)", "not printed",
            f"{bending:.3f}", "", f"a ball of radius {2 / bending:.1f} mm has as much; the face is 45 mm wide"]


def rows(results):
    return [*sampling_rows(results), *hemisphere_rows(results), *cone_rows(results), *hyperboloid_rows(results),
            nose_row()]
