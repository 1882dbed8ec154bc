# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of the filters that bring a scan from one frame to another."""
import math
import random

from drawing import BRIGHT, INK, PALE, SOLID, Picture


def turned(points, angle, shift):
    c, s = math.cos(angle), math.sin(angle)
    return [(c * x - s * y + shift[0], s * x + c * y + shift[1]) for x, y in points]


def axes(picture, origin, angle, name):
    for along in (angle, angle + math.pi / 2):
        picture.arrow(origin, (origin[0] + 0.6 * math.cos(along), origin[1] + 0.6 * math.sin(along)), INK)
    picture.text((origin[0] - 0.1, origin[1] - 0.3), name)


def align():
    """Four corners with noise, carried onto four measured ones by least squares."""
    picture = Picture(9, 3.4)
    source = random.Random(5)
    plate = [(-1, -0.6), (1, -0.6), (1, 0.6), (-1, 0.6)]
    part = [(-0.3, -0.25), (0.5, -0.25), (0.5, 0.05), (0.1, 0.35), (-0.3, 0.35)]
    scanned = turned([(x + source.gauss(0, 0.06), y + source.gauss(0, 0.06)) for x, y in plate], 0.5, (1.8, 1.8))
    measured = turned(plate, -0.1, (6.6, 1.8))
    mean = lambda points: tuple(sum(p[k] for p in points) / len(points) for k in (0, 1))
    a, b = mean(scanned), mean(measured)
    pairs = [((p[0] - a[0], p[1] - a[1]), (q[0] - b[0], q[1] - b[1])) for p, q in zip(scanned, measured)]
    angle = math.atan2(
        sum(p[0] * q[1] - p[1] * q[0] for p, q in pairs), sum(p[0] * q[0] + p[1] * q[1] for p, q in pairs)
    )
    moved = lambda points: turned([(x - a[0], y - a[1]) for x, y in points], angle, b)
    shape = turned(part, 0.5, (1.8, 1.8))
    picture.polygon(shape, SOLID)
    picture.polygon(moved(shape), SOLID)
    picture.polygon(scanned, "none", PALE)
    picture.polygon(moved(scanned), "none", PALE)
    for p in scanned:
        picture.dot(p, INK, 5)
    for p, q in zip(moved(scanned), measured):
        picture.line(p, q, BRIGHT, 2)
        picture.dot(p, INK, 5)
        picture.dot(q, BRIGHT, 6, hollow=True)
    picture.arrow((3.5, 1.8), (4.9, 1.8), INK)
    picture.text((1.2, 0.1), "source: scanner")
    picture.text((6, 0.1), "target: machine")
    return picture


def apply_transform():
    """A scanned profile with normals, in two frames."""
    picture = Picture(9, 3.4)
    curve = [(0.2 * i - 1.2, 0.35 * math.cos(1.6 * (0.2 * i - 1.2))) for i in range(13)]
    for angle, shift, name in ((0.35, (2.4, 1.9), "scanner"), (-0.25, (6.8, 1.9), "machine")):
        points = turned(curve, angle, shift)
        for p, before, after in zip(points[1:-1], points, points[2:]):
            x, y = after[0] - before[0], after[1] - before[1]
            length = math.hypot(x, y)
            picture.arrow(p, (p[0] - 0.45 * y / length, p[1] + 0.45 * x / length), BRIGHT)
        for p in points:
            picture.dot(p, INK, 4)
        axes(picture, (shift[0] - 2, 0.55), 0 if name == "machine" else 0.6, name)
    picture.arrow((4.2, 1.9), (5, 1.9), INK)
    return picture
