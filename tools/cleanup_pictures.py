# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the filters that clean scans and meshes."""
import math
import random

from drawing import BRIGHT, INK, PALE, SOLID, Picture
from plane_geometry import delaunay, scattered


def fill_holes():
    """The triangles of a Delaunay triangulation with a corner in a disc are the filling."""
    picture = Picture(8, 4)
    centre, radius = (4.3, 2.0), 1.15
    points = scattered(random.Random(17), 130, 0.38, 8, 4)
    triangles = [corners for corners, circle in delaunay(points) if circle[1] < 0.6]
    inside = lambda p: math.dist(p, centre) < radius
    filling = [t for t in triangles if any(inside(p) for p in t)]
    for t in triangles:
        if t not in filling:
            picture.polygon(t, SOLID, PALE)
    for t in filling:
        picture.polygon(t, "none", BRIGHT, 1.2)
    edges = lambda all_of: {frozenset((t[i], t[i - 1])) for t in all_of for i in range(3)}
    for edge in sorted(sorted(e) for e in edges(filling) & edges([t for t in triangles if t not in filling])):
        picture.line(*edge, INK, 2.5)
    for p in points:
        picture.dot(p, BRIGHT if inside(p) else INK, 3)
    return picture


def repair():
    """Left, separate triangles with a gap, a fin and a speck; right, the mended surface."""
    picture = Picture(10.4, 3.6)
    strip = [(0.4 + 0.9 * i, 1.0 if i % 2 else 2.5) for i in range(5)]
    triangles = [strip[i:i + 3] for i in range(3)]
    fin, speck = [strip[2], strip[3], (3.9, 2.9)], [(3.7, 0.5), (4.1, 0.5), (3.9, 0.8)]
    apart = [[tuple(c + 0.06 * (m - c) for c, m in zip(p, (sum(q[0] for q in t) / 3, sum(q[1] for q in t) / 3))) for p in t]
             for t in triangles]
    for t in [*apart, fin, speck]:
        picture.polygon(t, SOLID, INK, 1.5)
    middle = lambda t: (sum(p[0] for p in t) / 3, sum(p[1] for p in t) / 3)
    for turned, t in zip((False, True, False), apart):
        picture.text((middle(t)[0] - 0.08, middle(t)[1] - 0.08), "−" if turned else "+", BRIGHT if turned else INK)
    picture.arrow((4.7, 1.75), (5.5, 1.75))
    right = lambda p: (p[0] + 5.5, p[1])
    for t in triangles:
        picture.polygon([right(p) for p in t], SOLID, INK, 1.5)
        picture.text((right(middle(t))[0] - 0.08, right(middle(t))[1] - 0.08), "+")
    picture.polygon([(right(p)[0] + 0.15, p[1] + 0.08) for p in fin], SOLID, BRIGHT, 1.5)
    return picture


def profile(count):
    """Points on a smooth closed curve with a dent, with its outward normals."""
    points = []
    for i in range(count):
        a = 2 * math.pi * i / count
        at = lambda t: ((1.5 + 0.35 * math.cos(3 * t)) * 1.9 * math.cos(t) + 4, (1.5 + 0.35 * math.cos(3 * t)) * math.sin(t) + 2.1)
        (x, y), (u, v) = at(a - 1e-4), at(a + 1e-4)
        length = math.hypot(u - x, v - y)
        points.append((at(a), ((v - y) / length, (x - u) / length)))
    return points


def normals():
    picture = Picture(8, 4.2)
    points = profile(44)
    highest = max(range(len(points)), key=lambda i: points[i][0][1])
    for (p, _), (q, _) in zip(points, points[1:] + points[:1]):
        if p != points[(highest + 22) % 44][0]:
            picture.line(p, q, PALE, 2)
    for i, (p, n) in enumerate(points):
        colour = BRIGHT if i == highest else INK
        picture.arrow(p, (p[0] + 0.45 * n[0], p[1] + 0.45 * n[1]), colour)
        picture.dot(p, colour, 5 if i == highest else 3)
    return picture


def smooth():
    picture = Picture(8, 4.2)
    source = random.Random(8)
    points = profile(90)
    for (p, _), (q, _) in zip(points, points[1:] + points[:1]):
        picture.line(p, q, PALE, 1.5)
    for p, n in points:
        off = source.gauss(0, 0.13)
        noisy = (p[0] + off * n[0], p[1] + off * n[1])
        near = (p[0] + 0.12 * off * n[0], p[1] + 0.12 * off * n[1])
        picture.line(noisy, near, BRIGHT, 1)
        picture.dot(noisy, INK, 3, hollow=True)
        picture.dot(near, BRIGHT, 2.5)
    return picture


def poisson():
    """Part of the profile has no points; there, the surface is invented."""
    picture = Picture(8, 4.2)
    source = random.Random(3)
    curve = profile(180)
    missing = range(20, 44)
    for i, ((p, _), (q, _)) in enumerate(zip(curve, curve[1:] + curve[:1])):
        picture.line(p, q, BRIGHT if i in missing else SOLID, 3 if i in missing else 4)
    for i, (p, n) in enumerate(curve):
        if i % 4 == 0 and i not in missing:
            off = source.gauss(0, 0.05)
            at = (p[0] + off * n[0], p[1] + off * n[1])
            picture.arrow(at, (at[0] + 0.35 * n[0], at[1] + 0.35 * n[1]), INK)
            picture.dot(at, INK, 3)
    return picture
