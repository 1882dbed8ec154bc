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
