# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the filters that make and use patches, in the plane: triangles on both sides of a polygon, and a curve."""
import math

from drawing import BRIGHT, INK, PALE, SOLID, Picture

CENTRE = (3.4, 2.5)


def radius(angle):
    return 1.75 + 0.3 * math.cos(3 * angle)


def on_curve(angle, off=0.0):
    """The point at this angle, moved along the normal."""
    step = 1e-4
    at = lambda a: (CENTRE[0] + 1.3 * radius(a) * math.cos(a), CENTRE[1] + radius(a) * math.sin(a))
    (x, y), (u, v), (s, t) = at(angle), at(angle - step), at(angle + step)
    length = math.hypot(s - u, t - v)
    return (x + off * (t - v) / length, y - off * (s - u) / length)


def corners(count=9):
    return [2 * math.pi * (i + 0.2) / count for i in range(count)]


def curve(picture, colour=BRIGHT, width=2):
    places = [on_curve(2 * math.pi * i / 240) for i in range(241)]
    for p, q in zip(places, places[1:]):
        picture.line(p, q, colour, width)


def apexes(angles, height):
    """On both sides of every edge of the polygon, above its middle."""
    found = []
    for a, b in zip(angles, angles[1:] + [angles[0] + 2 * math.pi]):
        p, q = on_curve(a), on_curve(b)
        length = math.dist(p, q)
        normal = ((q[1] - p[1]) / length, (p[0] - q[0]) / length)
        middle = ((p[0] + q[0]) / 2, (p[1] + q[1]) / 2)
        found.append([(middle[0] + s * height * normal[0], middle[1] + s * height * normal[1]) for s in (1, -1)])
    return found


def hull(picture):
    angles = corners()
    places, above = [on_curve(a) for a in angles], apexes(corners(), 0.42)
    for i, p in enumerate(places):
        q = places[(i + 1) % len(places)]
        for side in (0, 1):
            picture.polygon([p, q, above[i][side]], SOLID)
            picture.polygon([p, above[i - 1][side], above[i][side]], "white")
        picture.line(p, q, INK, 1.5)
    for p in places:
        picture.dot(p, INK, 4)


def a_patch():
    picture = Picture(6.8, 5)
    hull(picture)
    curve(picture)
    return picture


def tessellate():
    picture = Picture(6.8, 5)
    hull(picture)
    places = [on_curve(a + k * 2 * math.pi / 9 / 4) for a in corners() for k in range(4)]
    for p, q in zip(places, places[1:] + places[:1]):
        picture.line(p, q, BRIGHT, 2)
        picture.dot(p, BRIGHT, 3)
    return picture


def patch_distance():
    picture = Picture(6.8, 5)
    curve(picture, INK)
    for i in range(30):
        angle, off = 2 * math.pi * (i + 0.4) / 30, 0.28 * math.sin(7.3 * i)
        picture.line(on_curve(angle), on_curve(angle, off), PALE, 1.5)
        picture.dot(on_curve(angle, off), BRIGHT if off > 0 else INK, 4)
    return picture
