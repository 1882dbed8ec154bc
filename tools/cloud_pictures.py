# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the filters that output points."""
import itertools
import math
import random

from drawing import BRIGHT, INK, PALE, SOLID, Picture

BLUE = "#3e80be"


def voxel_thin():
    """The same profile twice: above with voxels of one size, below with octree leaves limited by the curvature."""
    picture = Picture(8, 4.4)
    rng = random.Random(4)
    height = lambda x: 0.3 + 1.2 * math.exp(-(((x - 5.6) / 0.6) ** 2))

    def allowed(x, step=1e-3):
        slope = (height(x + step) - height(x - step)) / (2 * step)
        second = (height(x + step) - 2 * height(x) + height(x - step)) / step**2
        return min(1, math.sqrt(0.25 * (1 + slope * slope) ** 1.5 / max(abs(second), 1e-9)))

    points = [(x, height(x) + rng.uniform(-0.03, 0.03)) for x in (rng.uniform(0, 8) for _ in range(420))]

    def draw(cell, size, members, up):
        corners = [(cell[0] + u, cell[1] + v + up) for u, v in ((0, 0), (size, 0), (size, size), (0, size))]
        picture.polygon(corners, "none", INK)
        centre = (cell[0] + size / 2, cell[1] + size / 2)
        kept = min(members, key=lambda p: math.dist(p, centre))
        for p in members:
            picture.dot((p[0], p[1] + up), BRIGHT if p == kept else PALE, 5 if p == kept else 2)

    def cut(cell, size, members, up, limit):
        if not members:
            return
        if size <= min(limit(p[0]) for p in members):
            draw(cell, size, members, up)
            return
        half = size / 2
        for u, v in itertools.product((0, half), repeat=2):
            low = (cell[0] + u, cell[1] + v)
            inside = [p for p in members if all(low[k] <= p[k] < low[k] + half for k in (0, 1))]
            cut(low, half, inside, up, limit)

    cut((0, 0), 8, points, 2.4, lambda x: 0.25)
    cut((0, 0), 8, points, 0.1, allowed)
    return picture


def crop():
    """A box, a ball and the neighbourhood of a second scan, each with its own profile."""
    picture = Picture(9, 3.4)
    source = random.Random(9)
    height = lambda x: 1.3 + 0.6 * math.sin(2 * x)
    profile = [(0.15 + 0.085 * i, height(0.085 * i) + source.uniform(-0.05, 0.05)) for i in range(30)]
    low, high, centre, radius, within = (0.8, 0.9), (2.1, 2.2), (1.6, 1.6), 0.8, 0.3
    second = [(0.15 + x, height(x) + 0.25) for x in (0.9 + 0.1 * i for i in range(9))]
    inside = (
        lambda p: all(low[k] <= p[k] <= high[k] for k in (0, 1)),
        lambda p: math.dist(p, centre) <= radius,
        lambda p: min(math.dist(p, q) for q in second) <= within,
    )
    for i, contains in enumerate(inside):
        at = lambda p: (p[0] + 3 * i, p[1])
        if i == 0:
            corners = ((low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1]))
            picture.polygon([at(p) for p in corners], "none", INK)
        elif i == 1:
            picture.circle(at(centre), radius, INK)
        else:
            for q in second:
                picture.circle(at(q), within, PALE)
            for q in second:
                picture.dot(at(q), INK, 4)
        for p in profile:
            picture.dot(at(p), BRIGHT, 4, hollow=not contains(p))
        picture.text(at(((1.25, 0.2), (0.85, 0.2), (1.15, 0.2))[i]), ("box", "centre, radius", "within")[i])
    return picture


def merge():
    picture = Picture(9, 4)
    source = random.Random(6)
    curve = lambda t: (t, 1.5 + 0.9 * math.sin(t))
    first = [curve(0.4 + 0.16 * i + source.uniform(-0.02, 0.02)) for i in range(28)]
    second = [curve(3.2 + 0.16 * i + source.uniform(-0.02, 0.02)) for i in range(28)]
    turn, middle = 0.15, (5.4, 1.1)
    moved = lambda p: (
        middle[0] - 0.4 + (p[0] - middle[0]) * math.cos(turn) - (p[1] - middle[1]) * math.sin(turn),
        middle[1] + 1.2 + (p[0] - middle[0]) * math.sin(turn) + (p[1] - middle[1]) * math.cos(turn),
    )
    for p in second:
        picture.dot(moved(p), PALE, 3)
    picture.arrow(moved(second[-6]), second[-6], INK)
    picture.text((6.6, 2.75), "pose")
    for p in first:
        picture.dot(p, INK, 4)
    for p in second:
        near = min(math.dist(p, q) for q in first) < 0.13
        picture.dot(p, BRIGHT, 4, hollow=near)
    return picture


def outlier_removal():
    """The filter's method in the plane, with a line in place of the plane and six neighbours."""
    picture = Picture(9, 4.4)
    source = random.Random(3)
    neighbours, factor = 6, 3
    height = lambda x: 1.5 + 0.9 * math.sin(x)
    points = [(x, height(x)) for x in (0.4 + 0.075 * i + source.uniform(-0.02, 0.02) for i in range(100))]
    points += [(x, height(x)) for x in (8.05, 8.28, 8.5, 8.72)]  # sparse, but connected
    points += [(1.55, 2.72), (4.75, 0.98), (6.6, 2.25)]  # hovering
    points += [(2.4, 3.9), (3.6, 3.3), (5.2, 3.8), (5.35, 3.72), (7.9, 3.6), (0.7, 0.5), (3.2, 0.6), (6.1, 0.35)]
    nearest = [sorted(range(len(points)), key=lambda j: math.dist(points[j], p))[1 : neighbours + 1] for p in points]
    mean = [sum(math.dist(p, points[j]) for j in near) / neighbours for p, near in zip(points, nearest)]
    passed = set(range(len(points)))
    while True:
        values = [mean[i] for i in passed]
        average = sum(values) / len(values)
        limit = average + factor * math.sqrt(sum((v - average) ** 2 for v in values) / (len(values) - 1))
        left = {i for i in passed if mean[i] <= limit}
        if left == passed:
            break
        passed = left

    def hovers(i):
        near = [points[j] for j in nearest[i]]
        x, y = (sum(p[k] for p in near) / neighbours for k in (0, 1))
        offsets = [(p[0] - x, p[1] - y) for p in near]
        xx, xy, yy = (sum(o[a] * o[b] for o in offsets) for a, b in ((0, 0), (0, 1), (1, 1)))
        turn = math.atan2(2 * xy, xx - yy) / 2
        away = abs((points[i][1] - y) * math.cos(turn) - (points[i][0] - x) * math.sin(turn))
        return min(away, math.dist(points[i], near[0])) > 0.6 * mean[i]

    hovering = {i for i in range(len(points)) if i not in passed and hovers(i)}
    group = list(range(len(points)))

    def find(i):
        return i if group[i] == i else find(group[i])

    for i, near in enumerate(nearest):
        for j in near:
            distance = math.dist(points[i], points[j])
            mutual = i in nearest[j] and distance <= 2 * limit
            if not {i, j} & hovering and (mutual or ({i, j} <= passed and distance <= limit)):
                group[find(i)] = find(j)
    sizes = [sum(find(j) == find(i) for j in range(len(points))) for i in range(len(points))]
    for i, p in enumerate(points):
        outlier = sizes[i] <= neighbours
        picture.dot(p, BRIGHT if outlier else INK, 4, hollow=outlier)
    return picture


def transfer():
    """Noisy points in two colours give the vertices of a polyline the colour of most of their neighbours."""
    picture = Picture(8, 3.4)
    source = random.Random(12)
    surface = lambda x: 1.5 + 0.55 * math.sin(0.9 * x + 0.4)
    points = []
    for i in range(150):
        x = 0.3 + 7.4 * i / 149
        if 5.0 < x < 6.3:
            continue
        p = (x, surface(x) + source.gauss(0, 0.12))
        is_bright = (x > 2.9) != (source.random() < 0.08)
        points.append((p, is_bright))
        picture.dot(p, BRIGHT if is_bright else BLUE, 2.5)
    drawn = lambda p: (p[0], p[1] + 0.9)  # the mesh above its points
    vertices = [(0.3 + 7.4 * i / 20, surface(0.3 + 7.4 * i / 20)) for i in range(21)]
    for p, q in zip(vertices, vertices[1:]):
        picture.line(drawn(p), drawn(q), INK, 1.5)
    for v in vertices:
        near = sorted(points, key=lambda point: math.dist(point[0], v))[:12]
        if math.dist(near[0][0], v) > 0.25:
            picture.dot(drawn(v), PALE, 6)
            continue
        radius = math.dist(near[-1][0], v) ** 2 * 13 / 12
        weight = sum((1 if bright else -1) * (1 - math.dist(p, v) ** 2 / radius) for p, bright in near)
        picture.dot(drawn(v), BRIGHT if weight > 0 else BLUE, 6)
    return picture


def virtual_scan():
    picture = Picture(9, 4.4)
    centre, radius = (5.6, 2.2), 1.5
    picture.circle(centre, radius, PALE, SOLID)
    source = random.Random(8)
    for i in range(22):
        y = 0.2 + 0.19 * i
        across = radius**2 - (y - centre[1]) ** 2
        end = centre[0] - math.sqrt(across) if across > 0 else 8.8
        picture.line((1.0, y), (end, y), PALE, 0.8)
        if across > 0.25:
            picture.dot((end + source.gauss(0, 0.05), y), BRIGHT, 4)
    picture.dot((3.1, 3.6), BRIGHT, 4, hollow=True)
    picture.text((2.0, 3.72), "outlier")
    picture.polygon(((0.2, 1.7), (0.8, 1.7), (0.8, 2.7), (0.2, 2.7)), "white", INK, 1.5)
    picture.text((0.2, 1.4), "sensor")
    picture.text((7.25, 2.1), "hidden")
    return picture
