# SPDX-License-Identifier: GPL-3.0-or-later
"""The true surfaces, as meshes. Round surfaces have facets much smaller than the spacings used."""
from dataclasses import dataclass

import numpy


@dataclass
class Shape:
    name: str
    what: str
    genus: int
    vertices: numpy.ndarray  #: n × 3
    triangles: numpy.ndarray  #: n × 3 indices, counter-clockwise from outside


def grid_triangles(rows, columns):
    """Two triangles per square of a grid that is periodic in both directions; corner (i, j) is i * columns + j."""
    i, j = (index.ravel() for index in numpy.meshgrid(numpy.arange(rows), numpy.arange(columns), indexing="ij"))
    below, right = (i + 1) % rows, (j + 1) % columns
    a, b, c, d = i * columns + j, below * columns + j, below * columns + right, i * columns + right
    return numpy.concatenate([numpy.stack([a, b, c], axis=1), numpy.stack([a, c, d], axis=1)])


def torus(rows=400, columns=160):
    """A torus with radii 1 and 0.4."""
    around, along = numpy.meshgrid(2 * numpy.pi * numpy.arange(rows) / rows,
                                   2 * numpy.pi * numpy.arange(columns) / columns, indexing="ij")
    from_axis = 1 + 0.4 * numpy.cos(along)
    height = 0.4 * numpy.sin(along)
    vertices = numpy.stack([from_axis * numpy.cos(around), from_axis * numpy.sin(around), height], axis=2)
    return Shape("torus", "radii 1 and 0.4", 1, vertices.reshape(-1, 3), grid_triangles(rows, columns))


def sphere(cuts=6):
    """A sphere of radius 1: an octahedron, its triangles split into four `cuts` times, with vertices on the sphere."""
    vertices = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    for _ in range(cuts):
        middles, finer = {}, []
        for face in faces:
            inner = []
            for one, other in ((face[0], face[1]), (face[1], face[2]), (face[2], face[0])):
                edge = (min(one, other), max(one, other))
                if edge not in middles:
                    middles[edge] = len(vertices)
                    middle = numpy.add(vertices[one], vertices[other])
                    vertices.append(tuple(middle / numpy.linalg.norm(middle)))
                inner.append(middles[edge])
            ab, bc, ca = inner
            finer += [(face[0], ab, ca), (ab, face[1], bc), (ca, bc, face[2]), (ab, bc, ca)]
        faces = finer
    return Shape("sphere", "radius 1", 0, numpy.array(vertices, float), numpy.array(faces))


def block():
    """A plate of 5 × 3 × 1 with two square through holes of edge 1, made of unit cubes."""
    solid = {(x, y) for x in range(5) for y in range(3)} - {(1, 1), (3, 1)}
    corners, triangles = {}, []

    def quad(*places):
        a, b, c, d = (corners.setdefault(place, len(corners)) for place in places)
        triangles.extend([(a, b, c), (a, c, d)])

    for x, y in sorted(solid):
        quad((x, y, 1), (x + 1, y, 1), (x + 1, y + 1, 1), (x, y + 1, 1))
        quad((x, y, 0), (x, y + 1, 0), (x + 1, y + 1, 0), (x + 1, y, 0))
        sides = {(1, 0): ((x + 1, y), (x + 1, y + 1)), (0, 1): ((x + 1, y + 1), (x, y + 1)),
                 (-1, 0): ((x, y + 1), (x, y)), (0, -1): ((x, y), (x + 1, y))}
        for (dx, dy), (begin, end) in sides.items():
            if (x + dx, y + dy) not in solid:
                quad((*begin, 0), (*end, 0), (*end, 1), (*begin, 1))
    what = "5 × 3 × 1 with two square through holes of edge 1"
    return Shape("block", what, 2, numpy.array(list(corners), float), numpy.array(triangles))


def from_off(name, what, genus, path):
    """Reads a triangle mesh from an OFF file. Raises OSError, and ValueError for other content."""
    words = iter(path.read_text().split())
    if next(words, "") != "OFF":
        raise ValueError(f"{path} does not begin with OFF")
    points, faces, _ = int(next(words)), int(next(words)), next(words)
    rest = numpy.array(list(words), float)
    corners = rest[3 * points:3 * points + 4 * faces].reshape(faces, 4).astype(int)
    if not (corners[:, 0] == 3).all():
        raise ValueError(f"{path} has faces that are not triangles")
    return Shape(name, what, genus, rest[:3 * points].reshape(points, 3), corners[:, 1:])
