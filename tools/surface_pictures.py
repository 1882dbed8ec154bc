# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the filters that make or examine a surface."""
import itertools
import math
import random

from drawing import BRIGHT, INK, PALE, SOLID, Picture
from plane_geometry import circumcircle, delaunay, nearest_on_profile, scattered, spread_over


def region_grow():
    picture = Picture(8, 4)
    hole = (5.3, 2.1)
    points = scattered(random.Random(11), 120, 0.37, 8, 4, lambda p: math.dist(p, hole) > 0.85)
    triangles = [(corners, circle) for corners, circle in delaunay(points) if circle[1] < 0.6]
    grown = [t for t, circle in triangles if sum(p[0] + 0.3 * math.sin(2 * p[1]) for p in t) < 3 * 4.1]
    sides = {}
    for t in grown:
        picture.polygon(t, SOLID)
        for edge in itertools.combinations(t, 2):
            sides.setdefault(frozenset(edge), []).append(t)
    ends = {edge: len([t for t, _ in triangles if edge <= set(t)]) for edge in sides}
    front = [edge for edge, its in sides.items() if len(its) == 1 and ends[edge] == 2]
    for edge, its in sides.items():
        if len(its) == 1:
            picture.line(*edge, BRIGHT if edge in front else INK, 2.5)
    edge = min(front, key=lambda e: abs(sum(p[1] for p in e) / 2 - 2.9))
    corners, (centre, radius) = next((t, c) for t, c in triangles if edge <= set(t) and t not in grown)
    picture.polygon(corners, "none", BRIGHT, 1.5)
    picture.circle(centre, radius, BRIGHT, dash="4 3")
    picture.circle(hole, 0.85, PALE, dash="4 3")
    for p in points:
        picture.dot(p, radius=3)
    picture.dot(next(p for p in corners if p not in edge), BRIGHT, 6)
    return picture


def cluster_mesh():
    """Points are inserted slice by slice; the picture shows the triangles of one that closes a corner as well."""
    picture = Picture(8, 4)
    max_edge, spacing = 1.15, 1.15 / 4
    points = scattered(random.Random(22), 85, 0.4, 8, 4)
    order = sorted(points, key=lambda p: (round(p[0] / spacing), p[1]))
    triangles, waiting = [], []
    for count, p in enumerate(order):
        new = inserted(order[:count], triangles, p, max_edge)
        if p[0] > 4.3 and len(new) == 2:
            break
        triangles += new
        waiting.append(p)
        while new:
            waiting = [q for q in waiting if not any(q in t for t in triangles)]
            new = next(filter(None, (inserted(order[:count + 1], triangles, q, max_edge) for q in waiting)), [])
            triangles += new
    for i in range(1, int(8 / spacing)):
        picture.line((i * spacing, 0.1), (i * spacing, 3.9), PALE, 1, "2 4")
    for t in triangles:
        picture.polygon(t, SOLID)
    for a, b in boundary(triangles):
        picture.line(a, b, INK, 2.5)
    for t in new:
        picture.polygon(t, "none", BRIGHT, 1.5)
    picture.line(*new[0][:2], BRIGHT, 4)
    picture.circle(p, max_edge, BRIGHT, dash="4 3")
    for q in order:
        picture.dot(q, radius=3, hollow=order.index(q) > count)
    picture.dot(p, BRIGHT, 6)
    return picture


def boundary(triangles):
    """Directed edges of counterclockwise triangles that have no opposite."""
    edges = {(t[i], t[(i + 1) % 3]) for t in triangles for i in range(3)}
    return sorted(edge for edge in edges if edge[::-1] not in edges)


def inserted(points, triangles, p, max_edge):
    """The triangles that a new point adds: one at its winner edge, and one in every sharp corner beside it."""
    left = lambda a, b, c: (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    crosses = lambda a, b, c, d: left(a, b, c) * left(a, b, d) < 0 and left(c, d, a) * left(c, d, b) < 0
    holds = lambda t, q: q not in t and all(left(t[i], t[(i + 1) % 3], q) > 0 for i in range(3))
    outside_angle = lambda t: math.acos(sum((t[0][i] - t[1][i]) * (t[2][i] - t[1][i]) for i in (0, 1))
                                        / math.dist(t[0], t[1]) / math.dist(t[2], t[1]))

    def fits(t, among):
        edges = list(itertools.pairwise((*t, t[0])))
        sides = {tuple(sorted(edge)) for one in among for edge in itertools.combinations(one, 2)}
        return (left(*t) > 0.02 and all(math.dist(*edge) < max_edge for edge in edges)
                and not any(holds(t, q) for q in points)
                and not any(crosses(*edge, *side) for edge in edges for side in sides))

    if not triangles:
        firsts = [(a, b, p) for a, b in itertools.permutations(points, 2)]
        return [t for t in firsts if fits(t, [])][:1]
    by_distance = sorted(boundary(triangles), key=lambda edge: math.dist(p, nearest_on_profile(p, edge)))
    new = [t for t in ((b, a, p) for a, b in by_distance) if fits(t, triangles)][:1]
    while new:
        rim = boundary(triangles + new)
        corners = [(c, b, a) for a, b in rim for b2, c in rim if b == b2 and p in (a, c)]
        corners = [t for t in corners if fits(t, triangles + new) and outside_angle(t) < math.radians(150)]
        if not corners:
            break
        new.append(min(corners, key=outside_angle))
    return new


def delaunay_filter():
    picture = Picture(8, 4)
    points = scattered(random.Random(9), 26, 0.6, 8, 4)
    triangles = delaunay(points)
    for corners, _ in triangles:
        picture.polygon(corners, "none", INK)
    whole = [t for t in triangles if all(r < v < s - r for v, s, r in zip(t[1][0], (8, 4), (t[1][1], t[1][1])))]
    corners, (centre, radius) = max(whole, key=lambda t: t[1][1])
    picture.polygon(corners, SOLID, INK)
    picture.circle(centre, radius, BRIGHT)
    for p in points:
        picture.dot(p)
    return picture


def alpha_solid():
    picture = Picture(8, 5)
    body = lambda p: 1.1 < math.dist(p, (3.6, 2.5)) < 2.2 and not (p[0] > 3.6 and abs(p[1] - 2.5) < 0.75)
    points = scattered(random.Random(2), 150, 0.22, 8, 5, body)
    triangles = delaunay(points)
    alpha = 0.45
    edges = {}
    for index, (corners, _) in enumerate(triangles):
        for edge in itertools.combinations(sorted(corners), 2):
            edges.setdefault(edge, []).append(index)
    open_edge = lambda edge: math.dist(*edge) > 2 * alpha
    outside, queue = set(), []
    for edge, sides in edges.items():
        if len(sides) == 1 and open_edge(edge):
            queue.append(sides[0])
    while queue:
        index = queue.pop()
        if index in outside or triangles[index][1][1] <= alpha:
            continue
        outside.add(index)
        for edge in itertools.combinations(sorted(triangles[index][0]), 2):
            queue.extend(side for side in edges[edge] if side != index and open_edge(edge))
    for index, (corners, _) in enumerate(triangles):
        picture.polygon(corners, "none" if index in outside else SOLID, PALE, 0.7)
    for edge, sides in edges.items():
        if sum(side not in outside for side in sides) == 1:
            picture.line(*edge, INK, 2)
    for p in points:
        picture.dot(p, INK, 2.5)
    for centre in ((6.4, 2.5), (4.4, 2.5)):
        picture.circle(centre, alpha, BRIGHT)
    picture.line((6.4, 2.5), (6.4 + alpha, 2.5), BRIGHT, 1.5)
    picture.text((6.9, 2.4), "alpha", BRIGHT)
    return picture


def sculpt():
    picture = Picture(9.4, 3.4)
    profile = [(0.4, 2.8), (0.8, 2.6), (1.2, 2.3), (1.5, 1.9), (1.7, 1.45), (2.0, 1.2), (2.35, 1.15), (2.7, 1.4)]
    profile += [(2.9, 1.85), (3.2, 2.3), (3.6, 2.6), (4.0, 2.8)]
    ground = [(0.4 + 0.6 * i, 0.5) for i in range(7)]
    # The solid is below the profile. Before sculpting, cells that the ball cannot enter also fill the valley.
    lid = (2, 9)
    for shift, carved in ((0, False), (5, True)):
        moved = lambda p: (p[0] + shift, p[1])
        points = profile + ground
        middle = lambda corners: tuple(sum(p[i] for p in corners) / 3 for i in (0, 1))
        for corners, _ in delaunay(points):
            x, y = middle(corners)
            left = max(i for i, p in enumerate(profile) if p[0] <= x)
            a, b = profile[left], profile[left + 1]
            under = y < a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0])
            in_valley = not under and all(p in profile[lid[0] : lid[1] + 2] for p in corners) and y < 2.3
            fill = SOLID if under or (in_valley and not carved) else "none"
            picture.polygon([moved(p) for p in corners], fill, BRIGHT if in_valley and not carved else PALE, 1)
        surface = profile if carved else profile[: lid[0] + 1] + profile[lid[1] :]
        for a, b in itertools.pairwise(surface):
            picture.line(moved(a), moved(b), INK, 2)
        for p in points:
            hidden = p in profile[lid[0] + 1 : lid[1]] and not carved
            picture.dot(moved(p), BRIGHT if hidden else INK, 4)
    picture.arrow((4.35, 1.6), (5.05, 1.6))
    return picture


def decimate():
    """A profile with a corner: its vertices are removed while all that were removed stay within the distance."""
    picture = Picture(9, 3)
    corner, most = 44, 0.11
    height = lambda x: 1.6 + 0.9 * math.sin(1.3 * x) if x <= 4.6 else 1.33 - 0.85 * (x - 4.6) + 0.28 * (x - 4.6) ** 2
    heights = random.Random(4)
    profile = []
    for i in range(86):
        x = 0.2 + 0.1 * i
        profile.append((x, height(x) + heights.uniform(-0.035, 0.035)))
    segment_distance = lambda p, a, b: math.dist(p, nearest_on_profile(p, [a, b]))

    kept = list(range(len(profile)))
    while True:
        # The cheapest vertex whose removal keeps every vertex between its neighbours near their edge.
        costs = []
        for before, vertex, after in zip(kept, kept[1:], kept[2:]):
            passed = profile[before + 1 : after]
            cost = max(segment_distance(p, profile[before], profile[after]) for p in passed)
            if vertex != corner and cost <= most:
                costs.append((cost, vertex))
        if not costs:
            break
        kept.remove(min(costs)[1])

    for p in profile:
        picture.circle(p, most, SOLID, SOLID)
    for a, b in itertools.pairwise(profile):
        picture.line(a, b, PALE, 1)
    for p in profile:
        picture.dot(p, PALE, 3)
    for a, b in itertools.pairwise(kept):
        picture.line(profile[a], profile[b], INK, 2)
    for i in kept:
        picture.dot(profile[i], BRIGHT if i == corner else INK, 6 if i == corner else 5)
    picture.text((profile[corner][0] - 0.35, profile[corner][1] + 0.25), "corner", BRIGHT)
    return picture


def edge_flip():
    picture = Picture(11.2, 4.3)
    source = random.Random(4)
    points = scattered(source, 26, 0.5, 4.6, 3.6)
    triangles = swept(points)
    flipped = flip_to_delaunay(triangles)
    for x, corners_of, before in ((0.3, triangles, None), (6.3, flipped, triangles)):
        seen = lambda p: (p[0] + x, p[1] + 0.35)
        edges = lambda all_of: {frozenset(pair) for t in all_of for pair in itertools.combinations(t, 2)}
        kept = edges(before or flipped)
        for corners in corners_of:
            picture.polygon([seen(p) for p in corners], SOLID, PALE)
        for a, b in sorted(sorted(edge) for edge in edges(corners_of)):
            new = frozenset((a, b)) not in kept
            picture.line(seen(a), seen(b), BRIGHT if new else INK, 2 if new else 1)
        for p in points:
            picture.dot(seen(p), INK, 3)
    picture.arrow((5.1, 2.15), (6.1, 2.15))
    return picture


def swept(points):
    """A triangulation of the hull with bad angles: points by x, each joined to the hull of those before it."""
    left_of = lambda a, b, c: (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0
    triangles, lower, upper = [], [], []
    for p in sorted(points):
        for chain, left in ((lower, True), (upper, False)):
            while len(chain) > 1 and left_of(chain[-2], chain[-1], p) != left:
                triangles.append((chain[-2], chain[-1], p))
                chain.pop()
            chain.append(p)
    return triangles


def flip_to_delaunay(triangles):
    """Flips edges while a corner is inside the circumcircle of the triangle beyond an edge of its own triangle."""
    triangles = [tuple(sorted(t)) for t in triangles]
    while True:
        for one, two in itertools.combinations(triangles, 2):
            a, b = sorted(set(one) & set(two)) if len(set(one) & set(two)) == 2 else (None, None)
            if a is None:
                continue
            (c,), (d,) = set(one) - {a, b}, set(two) - {a, b}
            centre, radius = circumcircle(*one)
            if math.dist(d, centre) < radius - 1e-9:
                triangles = [t for t in triangles if t not in (one, two)] + [tuple(sorted((a, c, d))), tuple(sorted((b, c, d)))]
                break
        else:
            return triangles


def features():
    picture = Picture(10.6, 4.6)
    bend, centre, radius = math.radians(55), (-1.7, 1.5), 0.75
    bent = lambda p: (p[0], p[1], 0) if p[0] <= 0 else (p[0] * math.cos(bend), p[1], -p[0] * math.sin(bend))
    seen = lambda p: (3.6 + p[0] + 0.45 * p[1], 2.1 + 0.75 * p[1] + 0.9 * p[2])
    ring = [(centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in (2 * math.pi * i / 14 for i in range(14))]
    grid = [(0.65 * i, 0.75 * j) for i in range(-5, 4) for j in range(5)]
    # A regular grid would have four cocircular points in every cell.
    nudged = [(x + 0.02 * math.sin(7 * y) if x not in (0, -3.25, 1.95) else x, y) for x, y in grid]
    for half in (lambda p: p[0] <= 0, lambda p: p[0] >= 0):
        points = [p for p in nudged if half(p) and math.dist(p, centre) > 1.2 * radius]
        points += [p for p in ring if half(p)]
        for corners, _ in delaunay(points):
            middle = [sum(p[i] for p in corners) / 3 for i in (0, 1)]
            if math.dist(middle, centre) > radius:
                picture.polygon([seen(bent(p)) for p in corners], SOLID, PALE)
    border = [(-3.25, 0), (0, 0), (1.95, 0), (1.95, 3), (0, 3), (-3.25, 3)]
    for a, b in zip(border, border[1:] + border[:1]):
        picture.line(seen(bent(a)), seen(bent(b)), INK, 2.5)
    for a, b in zip(ring, ring[1:] + ring[:1]):
        picture.line(seen(bent(a)), seen(bent(b)), INK, 2.5, "5 3")
    picture.line(seen((0, 0, 0)), seen((0, 3, 0)), BRIGHT, 3)
    for p in border:
        picture.dot(seen(bent(p)), BRIGHT, 5)
    picture.text((0.1, 1.1), "outer boundary")
    picture.text((2.3, 3.15), "hole")
    picture.text((2.55, 1.75), "crease", BRIGHT)
    # Cross-section of the crease, with the angle between the two normals.
    foot, left, right = (8.3, 2.2), (6.5, 2.2), (8.3 + 1.8 * math.cos(bend), 2.2 - 1.8 * math.sin(bend))
    picture.line(left, foot, INK, 2.5)
    picture.line(foot, right, INK, 2.5)
    picture.arrow(foot, (8.3, 3.6), BRIGHT)
    picture.arrow(foot, (8.3 + 1.4 * math.sin(bend), 2.2 + 1.4 * math.cos(bend)), BRIGHT)
    arc = [(8.3 + 0.8 * math.sin(bend * i / 12), 2.2 + 0.8 * math.cos(bend * i / 12)) for i in range(13)]
    for a, b in itertools.pairwise(arc):
        picture.line(a, b, INK, 1)
    picture.text((8.55, 3.15), "angle")
    picture.dot(foot, BRIGHT, 5)
    return picture


def measure():
    picture = Picture(9, 4.2)
    truth = [(0.3, 0.8), (2.6, 0.8), (3.4, 3.2), (4.2, 0.8), (8.6, 0.8)]
    mesh = [(0.3, 1.1), (2.4, 1.2), (3.4, 1.9), (4.4, 1.2), (5.8, 1.0), (6.6, 2.3), (7.4, 1.0), (8.6, 1.1)]
    for one, other, colour in ((mesh, truth, INK), (truth, mesh, BRIGHT)):
        found = [(p, nearest_on_profile(p, other)) for p in [*spread_over(one, 0.3), *one]]
        farthest = max(found, key=lambda pair: math.dist(*pair))
        for p, q in found:
            picture.line(p, q, colour, 3 if (p, q) == farthest else 1, "" if (p, q) == farthest else "3 3")
    for profile, colour in ((truth, BRIGHT), (mesh, INK)):
        for a, b in itertools.pairwise(profile):
            picture.line(a, b, colour, 2)
        for p in spread_over(profile, 0.3):
            picture.dot(p, colour, 3)
    picture.text((6.85, 2.15), "mesh: too much")
    picture.text((0.9, 2.9), "truth: missing", BRIGHT)
    return picture


def inspect():
    """Points beside an open profile, with the ways to its nearest points; those beyond its ends are not counted."""
    picture = Picture(9, 3.6)
    nominal = [(1.2, 0.9), (3.0, 0.9), (3.0, 2.3), (5.6, 2.3), (6.2, 1.2), (7.9, 1.2)]
    source = random.Random(8)
    inside, outside = "#3e80be", "#de6634"
    scan = []
    for x, y in spread_over(nominal, 0.16):
        (u, v), way = nearest_on_profile((x, y), nominal), source.gauss(0, 0.03)
        way += 0.45 * max(0, 1 - abs(x - 4.3) / 0.7) * (y == 2.3) - 0.35 * max(0, 1 - abs(x - 7.1) / 0.6) * (y == 1.2)
        across = {0.9: (0, 1), 2.3: (0, 1), 1.2: (0, 1)}.get(y, (-1, 0) if x == 3.0 else (0.88, 0.48))
        scan.append((u + way * across[0], v + way * across[1]))
    scan += [(0.4 + 0.16 * i, 1.0 - 0.05 * i) for i in range(4)] + [(8.15 + 0.16 * i, 1.25 + 0.1 * i) for i in range(4)]
    picture.polygon([*nominal, (7.9, 0.3), (1.2, 0.3)], SOLID, SOLID)
    for p, q in itertools.pairwise(nominal):
        picture.line(p, q, INK, 2)
    for p in scan:
        foot = nearest_on_profile(p, nominal)
        beyond = p[0] < nominal[0][0] or p[0] > nominal[-1][0]
        if beyond:
            picture.dot(p, PALE, 4)
            continue
        (a, b) = min(itertools.pairwise(nominal), key=lambda edge: math.dist(p, nearest_on_profile(p, edge)))
        side = (b[0] - a[0]) * (p[1] - foot[1]) - (b[1] - a[1]) * (p[0] - foot[0])
        colour = outside if side > 0 else inside
        if math.dist(p, foot) > 0.1:
            picture.line(p, foot, colour, 1.5)
        picture.dot(p, colour if math.dist(p, foot) > 0.1 else INK, 4 if math.dist(p, foot) > 0.1 else 2.5)
    picture.text((3.75, 3.1), "+ outside", outside)
    picture.text((6.65, 0.5), "\u2212 inside", inside)
    picture.text((0.1, 1.5), "beyond the border", "#777777")
    return picture
