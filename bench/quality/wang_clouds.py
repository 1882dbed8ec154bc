# SPDX-License-Identifier: GPL-3.0-or-later
"""The clouds that Wang 2006 gives by formulas, and their closed forms.

Two things differ from the printed text. The thesis prints one formula for both x and y of the hemisphere; here x uses
the cosine of θ. Steps are rounded so that the tolerance holds everywhere; the thesis does not state its rounding.
"""
import math


def step_of(radius, tolerance):
    """The angle at which the distance between chord and arc is the tolerance."""
    return 2 * math.acos(1 - tolerance / radius)


def hemisphere(radius, tolerance):
    """Points on circles of latitude from the equator to the pole, with steps of at most step_of."""
    step = step_of(radius, tolerance)
    circles = math.ceil(math.pi / 2 / step)
    points = []
    for circle in range(circles):
        latitude = math.pi / 2 * circle / circles
        count = math.ceil(2 * math.pi * math.cos(latitude) / step)
        for number in range(count):
            longitude = 2 * math.pi * number / count
            points.append((radius * math.cos(latitude) * math.cos(longitude),
                           radius * math.cos(latitude) * math.sin(longitude), radius * math.sin(latitude)))
    return [*points, (0.0, 0.0, radius)]


def over_disc(radius, step, height):
    """Points of a square grid, centred on the disc, inside the disc and on its boundary."""
    reach = round(radius / step)
    return [(i * step, j * step, height(i * step, j * step)) for i in range(-reach, reach + 1)
            for j in range(-reach, reach + 1) if i * i + j * j <= reach * reach]


def cone():
    """A cone of radius and height 1."""
    return over_disc(1, 0.05, lambda x, y: 1 - math.sqrt(x * x + y * y))


RADIUS, SLOPE = 2, 3 / 2**2  # the thesis's r, and its a = h / r²


def hyperboloid():
    return over_disc(RADIUS, 0.04, lambda x, y: SLOPE * math.sqrt(max(x * x - y * y + RADIUS * RADIUS, 0)))


def hyperboloid_curvatures(point):
    """The two principal curvatures of F = z² − a² (x² − y² + r²) = 0, the larger first (Goldman 2005)."""
    x, y, z = point
    square = SLOPE * SLOPE
    gradient = (-2 * square * x, 2 * square * y, 2 * z)
    hessian = (-2 * square, 2 * square, 2)  # the matrix is diagonal
    squared = sum(g * g for g in gradient)
    bent = sum(h * g * g for h, g in zip(hessian, gradient))
    mean = (bent - squared * sum(hessian)) / (2 * squared**1.5)
    adjugate = (hessian[1] * hessian[2], hessian[0] * hessian[2], hessian[0] * hessian[1])
    gauss = sum(a * g * g for a, g in zip(adjugate, gradient)) / squared**2
    root = math.sqrt(max(mean * mean - gauss, 0))
    return sorted((abs(mean + root), abs(mean - root)), reverse=True)


def bin_size(bending, tolerance):
    """Equation 3.14: the edge of voxels for a sum of second derivatives M1 + 2 M2 + M3."""
    return 2 / 3 * math.sqrt(6 * tolerance / bending)


def bending_of(size, tolerance):
    """The inverse of equation 3.14: the sum of second derivatives for an edge of voxels."""
    return 8 / 3 * tolerance / (size * size)


CLOUDS = {
    "hemisphere-1": lambda: hemisphere(1, 0.005),
    "hemisphere-8-coarse": lambda: hemisphere(8, 0.025),
    "hemisphere-8": lambda: hemisphere(8, 0.005),
    "cone": cone,
    "hyperboloid": hyperboloid,
}


def write(points, path):
    path.write_text("".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in points))
