# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers of chapter 3 and of the clouds given by formulas: printed in the thesis, by closed forms, and ours."""
import math

import paper_wang as paper
import wang_clouds as clouds

HEADER = ["section", "what", "thesis", "by formula", "Scanmill", "reason for the difference"]


def sampling_rows(results):
    count, printed = results["points"], paper.COUNTS
    degrees = math.degrees(clouds.step_of(1, 0.005))
    more = [printed[name] / count[name] - 1 for name in ("hemisphere-1", "hemisphere-8-coarse", "hemisphere-8")]
    why = (f"we round the numbers of circles and of points per circle up, so that no step is too large; the thesis "
           f"does not state its rounding and has {100 * min(more):.1f} to {100 * max(more):.1f} % more points")
    yield ["3.6.1", "hemisphere, radius 1, tolerance 0.005: step", f"{paper.STEP_DEGREES}°", f"{degrees:.3f}°", "",
           "none: both are 2 acos(1 − tolerance / radius)"]
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
    yield [line.section, "hemisphere, radius 8, tolerance 0.025: voxel size", line.bin_size, f"{exact:.4f}",
           bin_text(thinning, "exact"),
           "1.2 corresponds to a sum of second derivatives of "
           f"{clouds.bending_of(line.bin_size, line.tolerance):.4f}, but a sphere of radius 8 has {bending}; points "
           "near the boundary have neighbours on one side only"]
    yield ["",
           "the same, with the coefficients a, b, c instead of the second derivatives 2 a, b, 2 c, as in equation "
           "3.9", "", f"{halved:.4f}", bin_text(thinning, "thesis"),
           f"voxels are then √2 times as large; 1.2 is near the corresponding edge Ω = √3 B = "
           f"{math.sqrt(3) * halved:.3f}"]
    binning = results["binning"]["hemisphere-8"]
    yield ["", "points kept with these two voxel sizes", line.kept, "", kept_text(thinning),
           f"voxels of the printed 1.2 keep {binning['kept']:,} points; voxels of {binning['bin_size']:.2f} keep 223"]


def cone_rows(results):
    line, thinning = paper.CONE, results["thinning"]["cone"]
    within = sum(x * x + y * y < 1 - 1e-9 for x, y, _ in clouds.cone())
    ours = clouds.bending_of(thinning["exact, nearest"]["bin_size"], line.tolerance)
    yield [line.section, "cone, radius and height 1, step 0.05: points", f"{paper.COUNTS['cone']:,}",
           f"{results['points']['cone']:,}", "",
           f"the formula includes the boundary; without it there are {within:,} points; rounding decides which are "
           "included"]
    yield ["", "largest curvature", paper.CONE_CURVATURE, "∞", f"{ours:.2f}",
           "the curvature is undefined at the apex, where a fit depends on the neighbours and the weights; ours is "
           "the sum of the second derivatives that determines the voxel size"]
    yield ["", "voxel size at a tolerance of 0.02", line.bin_size,
           f"{clouds.bin_size(paper.CONE_CURVATURE, line.tolerance):.4f} from 15.25", bin_text(thinning, "exact"),
           f"0.103 corresponds to {clouds.bending_of(line.bin_size, line.tolerance):.2f}, a third of the printed "
           f"curvature; with a, b, c as derivatives, ours is {bin_text(thinning, 'thesis')}"]


def hyperboloid_rows(results):
    line, thinning = paper.HYPERBOLOID, results["thinning"]["hyperboloid"]
    curvatures = [clouds.hyperboloid_curvatures(point) for point in clouds.hyperboloid()]
    largest, both = max(pair[0] for pair in curvatures), max(sum(pair) for pair in curvatures)
    ours = clouds.bending_of(thinning["exact, nearest"]["bin_size"], line.tolerance)
    yield [line.section, "hyperboloid, r = 2, h = 3, step 0.04: points", f"{paper.COUNTS['hyperboloid']:,}",
           f"{results['points']['hyperboloid']:,}", "",
           "as for the cone: the count depends on the points on the boundary"]
    yield ["", "largest curvature", paper.HYPERBOLOID_CURVATURE, f"{largest:.3f}; sum of both {both:.3f}",
           f"sum of both {ours:.3f}",
           "the printed number is near the sum of the two principal curvatures on the boundary, at y = ± r; fits there "
           "have neighbours on one side only"]
    yield ["", "voxel size", line.bin_size, f"at a tolerance of {line.bin_size**2 * both * 3 / 8:.4f}", "",
           "the thesis does not print the tolerance; this one gives 0.21"]
    binning = results["binning"]["hyperboloid"]
    yield ["", "points kept with voxels of 0.21", line.kept, "", f"{binning['kept']:,}",
           f"every occupied voxel keeps one point; voxels of {binning['bin_size']:.3f} keep 707"]


def nose_row():
    bending = clouds.bending_of(paper.NOSE_BIN, paper.NOSE_TOLERANCE)
    return ["4.4.2", "second derivatives at the nose, from a tolerance of 0.6 and voxels of 1.2 (per mm)",
            "not printed", f"{bending:.3f}", "", f"equal to those of a ball of radius {2 / bending:.1f} mm; the face "
            "is 45 mm wide"]


def rows(results):
    return [*sampling_rows(results), *hemisphere_rows(results), *cone_rows(results), *hyperboloid_rows(results),
            nose_row()]
