#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes five parts before and after a change, like those of Woo and Dey 2005, and batches that scan and update them.

    python3 worked_cases.py cases
    scanmill batch cases/scan.yaml -o cases/scans
    scanmill batch cases/update.yaml -o cases/updated

The paper's parts are not published; these have about as many points as its Table 1. Needs Python alone.
"""
from __future__ import annotations

import argparse
import itertools
import math
import pathlib
from collections.abc import Callable
from dataclasses import dataclass

Point = tuple[float, float, float]
Radius = Callable[[Point], float]  #: the distance of the surface from the origin, by direction

ROWS = 120  #: of a star's grid, from pole to pole
#: Points of voxel-thin, per area of a voxel's face.
PER_SQUARE = {"block": 0.99, "star": 1.33}
RAYS = 1.6  #: per edge of a voxel


@dataclass
class Solid:
    points: list[Point]
    faces: list[tuple[int, ...]]

    def write(self, file: pathlib.Path) -> None:
        rows = [f"{x:.6f} {y:.6f} {z:.6f}" for x, y, z in self.points]
        rows += [f"{len(face)} " + " ".join(map(str, face)) for face in self.faces]
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"OFF\n{len(self.points)} {len(self.faces)} 0\n" + "\n".join(rows) + "\n")

    def area(self, region: Region) -> float:
        """The area of the fans of triangles in the region."""
        total = 0.0
        for face in self.faces:
            corners = [self.points[i] for i in face]
            middle = tuple(sum(c) / len(face) for c in zip(*corners))
            if math.dist(middle, region.centre) > region.radius:
                continue
            for b, c in itertools.pairwise(corners[1:]):
                u, v = ([q[i] - corners[0][i] for i in range(3)] for q in (b, c))
                total += math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2
        return total


@dataclass
class Region:
    """A ball: what a scan shows."""

    centre: Point = (0, 0, 0)
    radius: float = 1000


@dataclass
class Case:
    name: str
    kind: str
    model: Solid
    points: int  #: of the model's scan
    changed: Solid
    scans: list[Region]  #: of the changes
    scan_points: int  #: of all clouds together


def boxes(*corners: tuple[Point, Point]) -> Solid:
    """Boxes that may overlap; scans show their outer surface. Faces are cut into squares."""
    solid = Solid([], [])
    for low, high in corners:
        for axis, end in itertools.product(range(3), (low, high)):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            counts = [max(1, round((high[i] - low[i]) / 2)) for i in (u, v)]
            first = len(solid.points)
            for i, j in itertools.product(range(counts[0] + 1), range(counts[1] + 1)):
                point = [0.0, 0.0, 0.0]
                point[axis] = end[axis]
                point[u] = low[u] + (high[u] - low[u]) * i / counts[0]
                point[v] = low[v] + (high[v] - low[v]) * j / counts[1]
                solid.points.append((point[0], point[1], point[2]))
            for i, j in itertools.product(range(counts[0]), range(counts[1])):
                a = first + i * (counts[1] + 1) + j
                face = (a, a + counts[1] + 1, a + counts[1] + 2, a + 1)
                solid.faces.append(face if end == high else face[::-1])
    return solid


def star(radius: Radius) -> Solid:
    """The closed surface at these distances from the origin."""
    def at(row: int, column: int) -> Point:
        polar, around = math.pi * row / ROWS, math.pi * column / ROWS
        way = (math.sin(polar) * math.cos(around), math.sin(polar) * math.sin(around), math.cos(polar))
        return (way[0] * radius(way), way[1] * radius(way), way[2] * radius(way))

    rows = [[0] * 2 * ROWS, *([1 + 2 * ROWS * row + i for i in range(2 * ROWS)] for row in range(ROWS - 1))]
    points = [at(0, 0), *(at(row, i) for row in range(1, ROWS) for i in range(2 * ROWS)), at(ROWS, 0)]
    rows.append([len(points) - 1] * 2 * ROWS)
    faces = [tuple(dict.fromkeys((a[i], b[i], b[i - 2 * ROWS + 1], a[i - 2 * ROWS + 1])))
             for a, b in itertools.pairwise(rows) for i in range(2 * ROWS)]
    return Solid(points, faces)


def ellipsoid(x: float, y: float, z: float) -> Radius:
    return lambda way: 1 / math.hypot(way[0] / x, way[1] / y, way[2] / z)


def raised(radius: Radius, towards: Point, width: float, height: float) -> Radius:
    """With a round pad, or a dent for a negative height, of this width in degrees."""
    length = math.hypot(*towards)

    def changed(way: Point) -> float:
        turn = math.acos(min(1, sum(a * b for a, b in zip(way, towards)) / length))
        share = turn / math.radians(width)
        flank = 1 if share < 0.6 else max(0.0, 0.5 + 0.5 * math.cos(math.pi * (share - 0.6) / 0.4)) * (share < 1)
        return radius(way) + height * flank
    return changed


def around(radius: Radius, towards: Point, size: float) -> Region:
    length = math.hypot(*towards)
    way = (towards[0] / length, towards[1] / length, towards[2] / length)
    return Region((way[0] * radius(way), way[1] * radius(way), way[2] * radius(way)), size)


def cases() -> list[Case]:
    block = ((-30, -20, -10), (30, 20, 10))
    legs = [((-14, -10, 10), (-8, 12, 16)), ((8, -10, 10), (14, 12, 16)), ((-8, 6, 10), (8, 12, 16))]
    airbag = ellipsoid(60, 45, 25)
    dents = [(-1, 0, 0.8), (0.6, 0.5, 0.8), (0.6, -0.5, 0.8)]
    dented = airbag
    for dent in dents:
        dented = raised(dented, dent, 13, -4)
    club = raised(ellipsoid(50, 40, 30), (0, -1, 0.2), 40, -6)
    worn = raised(raised(club, (0.7, 0.2, 1), 10, 3), (0.35, 0.2, 1), 8, -2)  # outside and inside
    joystick = raised(ellipsoid(20, 24, 60), (0, 0, 1), 40, 8)
    button = raised(joystick, (1, 0, 0.9), 22, 5)
    head = raised(raised(joystick, (0.5, 0, 1), 35, 12), (-0.6, 0, 1), 30, -8)
    return [
        Case("block", "block", boxes(block), 5991, boxes(block, *legs), [Region((0, 1, 10), 18.5)], 11488),
        Case("airbag", "star", star(airbag), 28650, star(dented), [around(airbag, dent, 12) for dent in dents], 34866),
        Case("golf-club", "star", star(club), 49380, star(worn), [around(club, (0.5, 0.2, 1), 17)], 4572),
        Case("joystick-1", "star", star(joystick), 37122, star(button), [around(joystick, (1, 0, 0.9), 19)], 10574),
        Case("joystick-2", "star", star(joystick), 37122, star(head), [Region((0, 0, 60), 54)], 32187),
    ]


SCAN = """scanmill: 1
name: scan
inputs:
  part: mesh
parameters:
  resolution: {default: 0.5 u, help: Distance between rays.}
  bin-size: {default: 1 u, help: Edge of the voxels that keep one point each.}
  centre: {default: [0 u, 0 u, 0 u], help: Middle of what the scan shows.}
  radius: {default: 1000 u, help: The scan shows the part up to this distance from the middle.}
steps:
  - virtual-scan: {views: 40, resolution: $resolution}
  - voxel-thin: {bin-size: $bin-size}
  - crop: {centre: $centre, radius: $radius}
outputs:
  "{folder}/{scan}.ply": crop
"""
UPDATE = """scanmill: 1
batch: update
summary: Makes a mesh of every first scan, and updates it from the scans of its changes.
scans:
  - {path: "scans/parts/*.ply", in: {clouds: "scans/changes/{stem}-*.ply"}}
workflows: [woo-dey-2005]
"""


def scan_of(file: str, solid: Solid, region: Region, points: float, kind: str) -> str:
    size = math.sqrt(PER_SQUARE[kind] * solid.area(region) / points)
    centre = ", ".join(f"{x:.4f} u" for x in region.centre)
    return (f"  - {{path: {file}, set: {{resolution: {size / RAYS:.4f} u, bin-size: {size:.4f} u, centre: [{centre}],"
            f" radius: {region.radius} u}}}}\n")


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("folder", type=pathlib.Path)
    options.add_argument("--share", type=float, default=1, help="of the paper's numbers of points (default: 1)")
    chosen = options.parse_args()
    scans = "scanmill: 1\nbatch: scan\nsummary: Scans every part before and after its change.\nscans:\n"
    for case in cases():
        file = f"parts/{case.name}.off"
        case.model.write(chosen.folder / file)
        scans += scan_of(file, case.model, Region(), case.points * chosen.share, case.kind)
        for i, region in enumerate(case.scans):
            file = f"changes/{case.name}-{i + 1}.off"
            case.changed.write(chosen.folder / file)
            points = case.scan_points * chosen.share / len(case.scans)
            scans += scan_of(file, case.changed, region, points, case.kind)
    (chosen.folder / "scan.yaml").write_text(scans + "workflows: [scan-part.yaml]\n")
    (chosen.folder / "scan-part.yaml").write_text(SCAN)
    (chosen.folder / "update.yaml").write_text(UPDATE)


main()
