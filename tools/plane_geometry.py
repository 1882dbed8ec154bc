# SPDX-License-Identifier: GPL-3.0-or-later
"""Points, triangles and polylines in the plane, for the pictures. Simple and slow."""
import itertools
import math


def circumcircle(a, b, c):
    """Centre and radius of the circle through three points; None if the points are collinear."""
    bx, by, cx, cy = b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]
    twice = 2 * (bx * cy - by * cx)
    if abs(twice) < 1e-12:
        return None
    x = (cy * (bx * bx + by * by) - by * (cx * cx + cy * cy)) / twice
    y = (bx * (cx * cx + cy * cy) - cx * (bx * bx + by * by)) / twice
    return (a[0] + x, a[1] + y), math.hypot(x, y)


def delaunay(points):
    """All triangles with an empty circumcircle, found by testing every three points."""
    triangles = []
    for corners in itertools.combinations(points, 3):
        circle = circumcircle(*corners)
        if circle and all(p in corners or math.dist(p, circle[0]) >= circle[1] for p in points):
            triangles.append((corners, circle))
    return triangles


def scattered(source, count, least, width, height, inside=lambda p: True):
    """Random points with a distance of more than `least` from each other."""
    points = []
    while len(points) < count:
        p = (source.uniform(0.2, width - 0.2), source.uniform(0.2, height - 0.2))
        if inside(p) and all(math.dist(p, q) > least for q in points):
            points.append(p)
    return points


def nearest_on_profile(p, profile):
    """The point of a polyline nearest to p."""
    best = None
    for (ax, ay), (bx, by) in itertools.pairwise(profile):
        along = ((p[0] - ax) * (bx - ax) + (p[1] - ay) * (by - ay)) / ((bx - ax) ** 2 + (by - ay) ** 2)
        along = min(1, max(0, along))
        q = (ax + along * (bx - ax), ay + along * (by - ay))
        if best is None or math.dist(p, q) < math.dist(p, best):
            best = q
    return best


def spread_over(profile, step):
    """Points at equal steps along a polyline."""
    at = step / 2
    for a, b in itertools.pairwise(profile):
        length = math.dist(a, b)
        while at < length:
            yield a[0] + (b[0] - a[0]) * at / length, a[1] + (b[1] - a[1]) * at / length
            at += step
        at -= length
