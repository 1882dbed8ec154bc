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


def icp():
    """A scan with a dent beside its nominal contour, and on it after point-to-line iterations with Tukey's weights."""
    picture = Picture(9, 3.6)
    source = random.Random(7)
    contour = [(-1.5, -0.9), (1.5, -0.9), (1.5, 0.1), (0.3, 0.1), (0.3, 0.9), (-1.5, 0.9)]
    sides = list(zip(contour, contour[1:] + contour[:1]))
    scan = []
    for (ax, ay), (bx, by) in sides:
        length = math.hypot(bx - ax, by - ay)
        outward = ((by - ay) / length, (ax - bx) / length)
        for k in range(1, round(length / 0.12)):
            s = k * 0.12 / length
            x, y = ax + s * (bx - ax), ay + s * (by - ay)
            offset = source.gauss(0, 0.02) - (0.22 if by == -0.9 and ay == -0.9 and abs(x) < 0.35 else 0)
            scan.append((x + offset * outward[0], y + offset * outward[1]))
    start = turned(scan, 0.09, (0.12, 0.14))
    moved, cut = start, 0.6
    for _ in range(30):
        rows = []
        for x, y in moved:
            feet = []
            for (ax, ay), (bx, by) in sides:
                ux, uy = bx - ax, by - ay
                s = min(1, max(0, ((x - ax) * ux + (y - ay) * uy) / (ux * ux + uy * uy)))
                feet.append((math.hypot(x - ax - s * ux, y - ay - s * uy), uy, -ux))
            r, nx, ny = min(feet)
            length = math.hypot(nx, ny)
            nx, ny = nx / length, ny / length
            inside = sum((ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax) for (ax, ay), (bx, by) in sides)
            r = -r if inside % 2 else r
            if abs(r) < cut:
                rows.append(((1 - (r / cut) ** 2) ** 2, r, (x * ny - y * nx, nx, ny)))
        h = [[sum(w * j[a] * j[b] for w, _, j in rows) for b in range(3)] for a in range(3)]
        g = [-sum(w * r * j[a] for w, r, j in rows) for a in range(3)]
        for a in range(3):  # Gauss and Jordan
            for b in range(3):
                if a != b:
                    f = h[b][a] / h[a][a]
                    h[b] = [p - f * q for p, q in zip(h[b], h[a])]
                    g[b] -= f * g[a]
        moved = turned(moved, g[0] / h[0][0], (g[1] / h[1][1], g[2] / h[2][2]))
        cut = max(0.08, cut / 1.5)
    for points, shift in ((start, (2.3, 1.8)), (moved, (6.7, 1.8))):
        picture.polygon([(x + shift[0], y + shift[1]) for x, y in contour], SOLID, INK)
        for x, y in points:
            picture.dot((x + shift[0], y + shift[1]), BRIGHT, 2.5)
    picture.arrow((4.2, 1.8), (4.8, 1.8), INK)
    picture.text((0.8, 0.25), "as it is: near the target")
    picture.text((5.3, 0.25), "refined: the dent does not pull")
    return picture


def plate_corners():
    """The outermost points of strips, a line through those of each side that agree, and their intersections."""
    picture = Picture(9, 4.2)
    source = random.Random(3)
    angle, middle, width, depth, strips = 0.18, (4.5, 2.1), 5.2, 2.8, 13
    plate = []
    for i in range(27):
        for k in range(15):
            x, y = (i - 13) * width / 27, (k - 7) * depth / 15
            on_part, bitten = -1.2 < x < 0.9 and -0.6 < y < 0.5, x > 1.7 and y > 0.95
            if not on_part and not bitten:
                plate.append((x + source.uniform(-0.05, 0.05), y + source.uniform(-0.05, 0.05)))
    to_picture = lambda points: turned(points, angle, middle)
    lines, border = [], []
    for axis, sign in ((1, -1), (0, 1), (1, 1), (0, -1)):
        length = (width, depth)[1 - axis]
        outermost = {}
        for p in plate:
            strip = math.floor((p[1 - axis] / length / 0.8 + 0.5) * strips)
            if 0 <= strip < strips and (strip not in outermost or sign * p[axis] > sign * outermost[strip][axis]):
                outermost[strip] = p
        heights = sorted(p[axis] for p in outermost.values())
        near = [p for p in outermost.values() if abs(p[axis] - heights[len(heights) // 2]) < 0.12]
        t = sum(p[1 - axis] for p in near) / len(near)
        h = sum(p[axis] for p in near) / len(near)
        slope = sum((p[1 - axis] - t) * (p[axis] - h) for p in near) / sum((p[1 - axis] - t) ** 2 for p in near)
        lines.append((axis, h - slope * t, slope))
        border += near
    corners = []
    for i in range(4):
        (_, a, s), (_, b, u) = sorted((lines[i - 1], lines[i]), reverse=True)  # y = a + s x, x = b + u y
        y = (a + s * b) / (1 - s * u)
        corners.append((b + u * y, y))
    part = [(-1.15, -0.55), (0.85, -0.55), (0.85, 0.45), (-1.15, 0.45)]
    picture.polygon(to_picture(part), SOLID)
    for p in to_picture(plate):
        picture.dot(p, PALE, 2)
    for p in to_picture(border):
        picture.dot(p, INK, 3)
    picture.polygon(to_picture(corners), "none", INK, 1.5)
    for p in to_picture(corners):
        picture.dot(p, BRIGHT, 6)
    return picture


def virtual_probe():
    """A ball that meets the edge of a wedge beside its reference point, and what the machine reports."""
    picture = Picture(9, 3.6)
    edge, half, radius, phi = (4.5, 1.7), math.radians(42), 0.8, math.radians(18)
    u = (-math.sin(phi), math.cos(phi))
    across = (u[1], -u[0])
    off = 0.38
    faces = [(edge[0] + s * 2.2 * math.sin(half), edge[1] - 2.2 * math.cos(half)) for s in (-1, 1)]
    picture.polygon([faces[0], edge, faces[1]], SOLID, INK)
    reference = (edge[0] + off * across[0], edge[1] + off * across[1])
    reach = math.sqrt(radius**2 - off**2)
    at = lambda s: (reference[0] + s * u[0], reference[1] + s * u[1])
    picture.circle(at(1.9), radius, PALE)
    picture.arrow(at(1.9), at(reach), INK)
    picture.circle(at(reach), radius, INK)
    picture.dot(at(reach), INK, 4)
    picture.line(at(reach), at(reach - radius), INK, 1, "4 3")
    picture.dot(at(reach - radius), BRIGHT, 5)
    picture.dot(reference, INK, 4, hollow=True)
    picture.dot(edge, INK, 4)
    picture.text((6.2, 0.9), "reported point", BRIGHT)
    picture.line((6.1, 0.95), at(reach - radius), BRIGHT, 1)
    picture.text((6.2, 1.4), "reference point")
    picture.line((6.1, 1.45), reference, INK, 1)
    picture.text((1.6, 1.6), "edge")
    picture.line((2.3, 1.65), edge, INK, 1)
    return picture


def probe_compensate():
    """The circles round the centres of two touches of one edge, and their intersection away from the approaches."""
    picture = Picture(9, 4)
    edge, half, radius, turn = (4.5, 1.5), math.radians(42), 1.1, math.radians(28)
    faces = [(edge[0] + s * 2 * math.sin(half), edge[1] - 2 * math.cos(half)) for s in (-1, 1)]
    picture.polygon([faces[0], edge, faces[1]], SOLID, INK)
    for s in (-1, 1):
        off = 0.2 + 0.12 * s  # of the reference point, which is beside the edge, across this approach
        u = (s * math.sin(turn), math.cos(turn))
        reach = math.sqrt(radius**2 - off**2)
        centre = (edge[0] + reach * u[0] + off * u[1], edge[1] + reach * u[1] - off * u[0])
        picture.circle(centre, radius, PALE if s < 0 else INK)
        picture.dot(centre, INK, 4)
        contact = (centre[0] - radius * u[0], centre[1] - radius * u[1])
        picture.arrow((centre[0] + 0.9 * u[0], centre[1] + 0.9 * u[1]), centre, INK)
        picture.line(centre, contact, INK, 1, "4 3")
        picture.dot(contact, INK, 4, hollow=True)
    picture.dot(edge, BRIGHT, 5)
    picture.text((6.6, 1.2), "point of the pair", BRIGHT)
    picture.line((6.5, 1.25), edge, BRIGHT, 1)
    picture.text((0.6, 0.8), "reported contacts")
    picture.line((2.95, 0.88), (edge[0] + 0.17, edge[1] - 0.02), INK, 1)
    return picture
