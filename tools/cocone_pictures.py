# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the filters that select a surface by the cocones of its points."""
import itertools
import math
import random

from drawing import BRIGHT, INK, PALE, SOLID, Picture
from plane_geometry import delaunay

CONE = math.radians(22.5)
CENTRE = (3.2, 2.5)


def outline(first, last, count, source):
    """Points of a bean, between two angles."""
    points = []
    for i in range(count):
        turn = first + (last - first) * (i + source.uniform(-0.12, 0.12)) / (count - 1)
        dent = math.exp(-((math.remainder(turn - 1.6, 2 * math.pi) / 0.5) ** 2))
        radius = 2.0 + 0.5 * math.cos(2 * turn) - 0.5 * dent
        points.append((CENTRE[0] + radius * math.cos(turn), CENTRE[1] + radius * math.sin(turn)))
    return points


class Sample:
    """Points of an open curve, their triangulation within a ring of distant points, and the edges of the cocones."""

    def __init__(self):
        self.points = outline(-0.25, 2 * math.pi - 1.0, 21, random.Random(7))
        turns = [0.3 + 0.524 * i for i in range(12)]
        self.ring = [(CENTRE[0] + 9 * math.cos(t), CENTRE[1] + 9 * math.sin(t)) for t in turns]
        self.cells = delaunay(self.points + self.ring)
        self.beside = {}
        for corners, circle in self.cells:
            for edge in itertools.combinations(corners, 2):
                self.beside.setdefault(frozenset(edge), []).append(circle[0])
        self.ends = (self.points[0], self.points[-1])
        self.surface = [edge for edge in self.beside if self.is_candidate(edge)]

    def pole(self, p):
        """The farthest corner of a point's Voronoi cell."""
        return max((circle[0] for corners, circle in self.cells if p in corners), key=lambda c: math.dist(c, p))

    def across(self, p, q):
        """The angle between a direction from p and the line to its pole."""
        pole = self.pole(p)
        turn = math.atan2(q[1] - p[1], q[0] - p[0]) - math.atan2(pole[1] - p[1], pole[0] - p[0])
        return abs(math.asin(math.cos(turn)))

    def is_candidate(self, edge):
        """Whether the dual Voronoi edge meets the cocones of both ends; an edge between the curve's ends is none."""
        if edge & set(self.ring) or edge == set(self.ends) or len(self.beside[edge]) < 2:
            return False
        (ax, ay), (bx, by) = self.beside[edge]
        on_dual = [(ax + (bx - ax) * i / 200, ay + (by - ay) * i / 200) for i in range(201)]
        return all(any(self.across(p, q) <= CONE for q in on_dual) for p in edge)

    def voronoi_cell(self, p):
        """The corners of a point's Voronoi cell, in order round the point."""
        centres = [circle[0] for corners, circle in self.cells if p in corners]
        return sorted(centres, key=lambda c: math.atan2(c[1] - p[1], c[0] - p[0]))

    def outside(self):
        """The cells outside: labels spread from the ring, and along the curve from edge to edge."""
        edges = {corners: [frozenset(edge) for edge in itertools.combinations(corners, 2)] for corners, _ in self.cells}
        cells_at = {}
        for corners in edges:
            for edge in edges[corners]:
                cells_at.setdefault(edge, []).append(corners)

        def same_side(cell, p):
            """The cells at p that are reached from this one without crossing the curve."""
            reached, queue = {cell}, [cell]
            while queue:
                for edge in edges[queue.pop()]:
                    if p in edge and edge not in self.surface:
                        new = [other for other in cells_at[edge] if other not in reached]
                        reached.update(new)
                        queue += new
            return reached

        good = [p for p in self.points if p not in self.ends]
        labels = {(cell, p) for cell in edges if set(cell) & set(self.ring) for p in cell if p in good}
        while True:
            spread = {(other, p) for cell, p in labels for other in same_side(cell, p)}
            along = {(cell, q) for cell, p in spread for edge in edges[cell]
                     if p in edge and edge in self.surface for q in edge if q in good}
            if spread | along == labels:
                break
            labels = spread | along
        return {cell for cell in edges if all((cell, p) in labels for p in cell if p in good)}


def clipped(corners, keeps):
    """A convex polygon cut by a half-plane; keeps(p) is positive inside."""
    found = []
    for p, q in zip(corners, corners[1:] + corners[:1]):
        a, b = keeps(p), keeps(q)
        if a >= 0:
            found.append(p)
        if a * b < 0:
            found.append((p[0] + (q[0] - p[0]) * a / (a - b), p[1] + (q[1] - p[1]) * a / (a - b)))
    return found


def cocone():
    """Voronoi edges of the points; the cocone of one point, and the edges of the curve."""
    picture = Picture(6.4, 5)
    sample = Sample()
    box = [lambda p: p[0] - 0.1, lambda p: 6.3 - p[0], lambda p: p[1] - 0.1, lambda p: 4.9 - p[1]]

    def inside_box(corners):
        for side in box:
            corners = clipped(corners, side) if corners else corners
        return corners

    for p in sample.points:
        picture.polygon(inside_box(sample.voronoi_cell(p)), "none", PALE, 0.7)
    for chosen in (sample.points[2], sample.points[8]):
        pole = sample.pole(chosen)
        up = math.atan2(pole[1] - chosen[1], pole[0] - chosen[0])
        cell = inside_box(sample.voronoi_cell(chosen))
        picture.polygon(cell, "none", INK, 1.2)
        for tangent in (up + math.pi / 2, up - math.pi / 2):
            # Between the two lines at CONE from the tangent.
            wedge = cell
            for limit, sign in ((tangent - CONE, 1), (tangent + CONE, -1)):
                wedge = clipped(wedge, lambda q, limit=limit, sign=sign: sign * (
                    math.cos(limit) * (q[1] - chosen[1]) - math.sin(limit) * (q[0] - chosen[0])))
            picture.polygon(wedge, SOLID, BRIGHT, 1)
    for edge in sample.surface:
        picture.line(*sorted(edge), INK, 2.5)
    for p in sample.points:
        picture.dot(p, BRIGHT if p in sample.ends else INK, 4, hollow=p in sample.ends)
    return picture


def tight_cocone():
    """The cells inside, the edges of the curve, and those that close its gap."""
    picture = Picture(6.4, 5)
    sample = Sample()
    outside = sample.outside()
    count = {}
    for corners, _ in sample.cells:
        if set(corners) & set(sample.ring):
            continue
        picture.polygon(corners, "none" if corners in outside else SOLID, PALE, 0.7)
    for corners, _ in sample.cells:
        for edge in itertools.combinations(corners, 2):
            edge = frozenset(edge)
            count[edge] = count.get(edge, 0) + (corners not in outside)
    for edge, inner in count.items():
        if inner == 1:
            picture.line(*sorted(edge), INK if edge in sample.surface else BRIGHT, 2.5)
    for p in sample.points:
        picture.dot(p, BRIGHT if p in sample.ends else INK, 4, hollow=p in sample.ends)
    return picture
