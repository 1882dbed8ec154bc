# SPDX-License-Identifier: GPL-3.0-or-later
"""Picture of the filter that updates a mesh from a scan of its changed part."""
import itertools
import math
import random

from drawing import BRIGHT, INK, SOLID, Picture
from plane_geometry import nearest_on_profile

ADDED = "#3e80be"


def along(corners, step):
    """Points of a polyline at equal distances, beginning with its first corner."""
    points, rest = [], 0.0
    for p, q in itertools.pairwise(corners):
        length = math.dist(p, q)
        while rest <= length:
            points.append((p[0] + (q[0] - p[0]) * rest / length, p[1] + (q[1] - p[1]) * rest / length))
            rest += step
        rest -= length
    return points


def angle(at, p, q):
    """The angle at a point between the directions to two others, in degrees."""
    turn = math.atan2(p[1] - at[1], p[0] - at[0]) - math.atan2(q[1] - at[1], q[0] - at[0])
    return abs(math.degrees(math.remainder(turn, 2 * math.pi)))


def arc(picture, at, p, q, radius):
    """The arc from the direction to p to that to q, on the shorter way."""
    first = math.atan2(p[1] - at[1], p[0] - at[0])
    turn = math.remainder(math.atan2(q[1] - at[1], q[0] - at[0]) - first, 2 * math.pi)
    places = [(at[0] + radius * math.cos(first + turn * i / 24), at[1] + radius * math.sin(first + turn * i / 24))
              for i in range(25)]
    for one, other in itertools.pairwise(places):
        picture.line(one, other, BRIGHT, 1.5)


def mesh_update():
    """A section through a block, and the cloud of a pad on it; at its left end, the angles that decide."""
    picture = Picture(9.6, 4.3)
    source = random.Random(4)
    model = along([(0.6, 0.1), (0.6, 2.2), (9.0, 2.2), (9.0, 0.1)], 0.7)
    cloud = [(x + source.gauss(0, 0.01), y + source.gauss(0, 0.01))
             for x, y in along([(2.35, 2.36), (4.0, 2.22), (4.0, 3.5), (6.2, 3.5), (6.2, 2.22), (7.7, 2.26)], 0.235)]
    facets = list(itertools.pairwise(model))
    ends = (cloud[0], cloud[-1])
    overlap = {min(facets, key=lambda facet: math.dist(end, nearest_on_profile(end, facet))) for end in ends}
    first, last = sorted(i for i, facet in enumerate(facets) if facet in overlap)
    groups = {"kept": facets[:first] + facets[last + 1:], "replaced": facets[first + 1:last]}

    picture.polygon(model, SOLID, SOLID)
    for group, colour, dash in (("kept", INK, ""), ("replaced", "#777777", "5 4")):
        for p, q in groups[group]:
            picture.line(p, q, colour, 2, dash)
    for p, q in overlap:
        picture.line(p, q, BRIGHT, 5)
    for p in model:
        picture.dot(p, INK, 3.5)
    for p, q in itertools.pairwise(cloud):
        picture.line(p, q, ADDED, 1.5)
    end, beside = cloud[0], cloud[1]
    foot = nearest_on_profile(end, facets[first])
    angles = {}
    for name, radius in (("replaced", 1.25), ("kept", 0.4)):
        vertex = min((p for facet in groups[name] for p in facet if p in facets[first]),
                     key=lambda p: math.dist(p, end))
        length = math.dist(foot, vertex)
        direction = (end[0] + (vertex[0] - foot[0]) / length, end[1] + (vertex[1] - foot[1]) / length)
        picture.line(end, (end[0] + (radius + 0.1) * (direction[0] - end[0]), end[1]), BRIGHT, 1.5)
        arc(picture, end, beside, direction, radius)
        angles[name] = angle(end, beside, direction)
    for p in cloud:
        picture.dot(p, ADDED, 3.5)
    picture.text((2.1, 1.65), f"{angles['kept']:.0f}°", BRIGHT)
    picture.text((3.35, 2.45), f"{angles['replaced']:.0f}°", BRIGHT)
    picture.text((4.4, 3.65), "cloud of a new pad", ADDED)
    picture.text((0.75, 1.0), "kept group: near 180°")
    picture.text((4.1, 1.85), "replaced group: near 0°", "#777777")
    picture.text((6.8, 1.0), "overlap facets", BRIGHT)
    picture.line((7.3, 1.25), (7.4, 2.1), BRIGHT)
    return picture
