# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed meshes, features, and exact booleans of both, for the benches of mesh-update."""
from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, field

import manifold3d
import numpy
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, Delaunay

Array = NDArray[numpy.float64]
Indices = NDArray[numpy.int64]

GOLDEN_ANGLE = numpy.pi * (3 - numpy.sqrt(5))
#: Facets around round features; they deviate by less than 0.1 % of the radius.
SEGMENTS = 96


@dataclass
class Mesh:
    """A triangle mesh, counter-clockwise from outside. Its arrays must not change after the first property."""

    vertices: Array
    faces: Indices
    #: For each face, the solid whose face contains it; empty if the mesh is not the result of a boolean.
    origin: Indices = field(default_factory=lambda: numpy.empty(0, int))

    def corners(self) -> tuple[Array, Array, Array]:
        a, b, c = (self.vertices[self.faces[:, i]] for i in range(3))
        return a, b, c

    def cross(self) -> Array:
        a, b, c = self.corners()
        return numpy.cross(b - a, c - a)

    @functools.cached_property
    def areas(self) -> Array:
        return numpy.linalg.norm(self.cross(), axis=1) / 2

    @functools.cached_property
    def normals(self) -> Array:
        cross = self.cross()
        length = numpy.linalg.norm(cross, axis=1, keepdims=True)
        return cross / numpy.where(length > 0, length, 1)

    @functools.cached_property
    def area(self) -> float:
        return float(self.areas.sum())

    @functools.cached_property
    def extents(self) -> Array:
        return numpy.ptp(self.vertices, axis=0)

    def volume(self) -> float:
        a, b, c = self.corners()
        return float(numpy.einsum("ij,ij->i", a, numpy.cross(b, c)).sum() / 6)

    @functools.cached_property
    def used(self) -> int:
        """The number of vertices of faces."""
        return len(numpy.unique(self.faces))

    @functools.cached_property
    def euler(self) -> int:
        """Vertices − edges + faces, without unused vertices."""
        return self.used - len(numpy.unique(undirected(self.faces), axis=0)) + len(self.faces)

    @functools.cached_property
    def longest_edge(self) -> float:
        a, b, c = self.corners()
        return float(max(numpy.linalg.norm(one - other, axis=1).max() for one, other in ((a, b), (b, c), (c, a))))

    @functools.cached_property
    def median_edge(self) -> float:
        edges = numpy.unique(undirected(self.faces), axis=0)
        return float(numpy.median(numpy.linalg.norm(self.vertices[edges[:, 0]] - self.vertices[edges[:, 1]], axis=1)))

    def part(self, faces: NDArray) -> Mesh:
        """These faces with all vertices."""
        return Mesh(self.vertices, self.faces[faces], self.origin[faces] if len(self.origin) else self.origin)


def undirected(faces: Indices) -> Indices:
    return numpy.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)


def is_closed(mesh: Mesh) -> bool:
    """Whether every edge has two triangles, in opposite directions, and every vertex one fan."""
    half_edges = mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    size = len(mesh.vertices)
    keys = half_edges[:, 0] * size + half_edges[:, 1]
    opposite = half_edges[:, 1] * size + half_edges[:, 0]
    if len(numpy.unique(keys)) != len(keys) or not numpy.array_equal(numpy.sort(keys), numpy.sort(opposite)):
        return False
    # A vertex with several fans has corners that are not connected through edges of the fan.
    return components_of_corners(mesh.faces, keys, opposite) == mesh.used


def components_of_corners(faces: Indices, keys: Indices, opposite: Indices) -> int:
    """The number of fans: corners of a vertex are connected if their faces share an edge at that vertex."""
    order = numpy.argsort(keys)
    partner = order[numpy.searchsorted(keys[order], opposite)]
    # Half-edge 3 f + i leaves corner i of face f. Its opposite one enters that vertex, so the next one leaves it.
    next_of = numpy.arange(len(keys)).reshape(-1, 3)[:, [1, 2, 0]].ravel()
    return components(len(keys), numpy.stack([numpy.arange(len(keys)), next_of[partner]], axis=1))


def components(count: int, edges: Indices) -> int:
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    ones = numpy.ones(len(edges), bool)
    graph = coo_matrix((ones, (edges[:, 0], edges[:, 1])), shape=(count, count))
    return int(connected_components(graph, directed=False)[0])


def face_components(faces: Indices) -> int:
    """The number of sets of faces that are connected through edges."""
    if not len(faces):
        return 0
    edges, inverse = numpy.unique(undirected(faces), axis=0, return_inverse=True)
    owner = numpy.repeat(numpy.arange(len(faces)), 3)
    return components(len(faces) + len(edges), numpy.stack([owner, len(faces) + inverse.ravel()], axis=1))


# Solids


def solid_of(mesh: Mesh) -> manifold3d.Manifold:
    """The mesh as a solid of its own origin."""
    made = manifold3d.Manifold(manifold3d.Mesh64(
        vert_properties=numpy.ascontiguousarray(mesh.vertices, float),
        tri_verts=numpy.ascontiguousarray(mesh.faces, numpy.uint64),
        run_index=numpy.array([0, 3 * len(mesh.faces)], numpy.uint64),
        run_original_id=numpy.array([manifold3d.Manifold.reserve_ids(1)], numpy.uint32)))
    if made.status() != manifold3d.Error.NoError or made.is_empty():
        raise ValueError(f"not a closed mesh: {made.status()}")
    return made


def origins(solid: manifold3d.Manifold) -> set[int]:
    return {int(one) for one in solid.to_mesh64().run_original_id}


def mesh_of(solid: manifold3d.Manifold) -> Mesh:
    made = solid.to_mesh64()
    faces = numpy.asarray(made.tri_verts).astype(int)
    counts = numpy.diff(numpy.asarray(made.run_index).astype(int)) // 3
    return Mesh(numpy.asarray(made.vert_properties)[:, :3].copy(), faces,
                numpy.repeat(numpy.asarray(made.run_original_id).astype(int), counts))


# Models. All are about 100 units long.


def fibonacci_sphere(count: int) -> Array:
    rows = numpy.arange(count)
    height = 1 - (2 * rows + 1) / count
    around, angle = numpy.sqrt(1 - height**2), GOLDEN_ANGLE * rows
    return numpy.stack([around * numpy.cos(angle), around * numpy.sin(angle), height], axis=1)


def hull(points: Array) -> Mesh:
    """The hull of points that surround the origin and are all on it."""
    faces = ConvexHull(points).simplices.astype(int)
    mesh = Mesh(points, faces)
    inward = numpy.einsum("ij,ij->i", mesh.cross(), points[faces[:, 0]]) < 0
    faces[inward] = faces[inward][:, ::-1]
    return Mesh(points, faces)


def ellipsoid(count: int, axes: tuple[float, float, float]) -> Mesh:
    sphere = hull(fibonacci_sphere(count))
    return Mesh(sphere.vertices * numpy.array(axes), sphere.faces)


def sphere(count: int) -> Mesh:
    return ellipsoid(count, (50, 50, 50))


def torus(count: int, ring: float = 35, tube: float = 15) -> Mesh:
    rows = max(8, round(numpy.sqrt(count * ring / tube)))
    columns = max(6, round(count / rows))
    around, along = numpy.meshgrid(2 * numpy.pi * numpy.arange(rows) / rows,
                                   2 * numpy.pi * numpy.arange(columns) / columns, indexing="ij")
    # Every second row is turned by half a step, so that triangles are nearly equilateral.
    along = along + numpy.pi / columns * (numpy.arange(rows) % 2)[:, None]
    from_axis = ring + tube * numpy.cos(along)
    vertices = numpy.stack([from_axis * numpy.cos(around), from_axis * numpy.sin(around), tube * numpy.sin(along)],
                           axis=2).reshape(-1, 3)
    i, j = (index.ravel() for index in numpy.meshgrid(numpy.arange(rows), numpy.arange(columns), indexing="ij"))
    below, right, turned = (i + 1) % rows, (j + 1) % columns, i % 2
    a, b, c, d = i * columns + j, below * columns + j, below * columns + right, i * columns + right
    # An odd number of rows leaves one strip with equal turns; it only has slightly skewed triangles.
    one = numpy.where(turned[:, None], numpy.stack([a, c, d], axis=1), numpy.stack([a, b, d], axis=1))
    other = numpy.where(turned[:, None], numpy.stack([a, b, c], axis=1), numpy.stack([b, c, d], axis=1))
    return Mesh(vertices, numpy.concatenate([one, other]))


def cylinder(count: int, radius: float = 28, height: float = 90) -> Mesh:
    """Rows of a grid around the side, and concentric rings in both discs."""
    edge = numpy.sqrt(2 * numpy.pi * radius * (height + radius) / count)
    around = max(12, round(2 * numpy.pi * radius / edge))
    rows = max(2, round(height / edge))
    angle = 2 * numpy.pi * numpy.arange(around) / around
    circle = radius * numpy.stack([numpy.cos(angle), numpy.sin(angle)], axis=1)
    rings = max(2, round(radius / edge))
    disc = [numpy.zeros((1, 2))]
    for ring in range(1, rings):
        here = 2 * numpy.pi * (numpy.arange(max(6, round(around * ring / rings))) + ring % 2 / 2)
        here = here / max(6, round(around * ring / rings))
        disc.append(radius * ring / rings * numpy.stack([numpy.cos(here), numpy.sin(here)], axis=1))
    inner = numpy.concatenate(disc)
    flat = Delaunay(numpy.concatenate([circle, inner])).simplices.astype(int)
    a, b, c = (numpy.concatenate([circle, inner])[flat[:, i]] for i in range(3))
    side = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    flat[side < 0] = flat[side < 0][:, ::-1]
    heights = height * (numpy.arange(rows + 1) / rows - 0.5)
    vertices = [numpy.column_stack([circle, numpy.full(around, z)]) for z in heights]
    vertices += [numpy.column_stack([inner, numpy.full(len(inner), z)]) for z in (heights[0], heights[-1])]
    i, j = (index.ravel() for index in numpy.meshgrid(numpy.arange(rows), numpy.arange(around), indexing="ij"))
    a, b = i * around + j, i * around + (j + 1) % around
    wall = numpy.concatenate([numpy.stack([a, b, b + around], axis=1),
                              numpy.stack([a, b + around, a + around], axis=1)])
    first_inner = (rows + 1) * around
    low = numpy.where(flat < around, flat, flat - around + first_inner)[:, ::-1]
    high = numpy.where(flat < around, flat + rows * around, flat - around + first_inner + len(inner))
    return Mesh(numpy.concatenate(vertices), numpy.concatenate([wall, low, high]))


def box(size: tuple[float, float, float]) -> Mesh:
    return mesh_of(manifold3d.Manifold.cube(size, True))


def box_of_12(_count: int = 0) -> Mesh:
    return box((100, 70, 45))


def of_cubes(cells: NDArray[numpy.bool_], edge: float) -> Mesh:
    """The boundary of a set of cubes: two triangles per square, all with the same diagonal."""
    padded = numpy.pad(cells, 1)
    squares = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, 1):  # low faces, then high faces
            beside = numpy.roll(padded, 1 if side == 0 else -1, axis)
            at = numpy.argwhere(padded & ~beside)
            at[:, axis] += side
            corner = [at + (numpy.eye(3, dtype=int)[u] * i + numpy.eye(3, dtype=int)[v] * j)
                      for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
            squares.append(numpy.stack(corner if side else corner[::-1], axis=1))
    places, rows = numpy.unique(numpy.concatenate(squares).reshape(-1, 3), axis=0, return_inverse=True)
    quads = rows.reshape(-1, 4)
    return Mesh((places - 1) * edge, numpy.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))


def l_block(count: int) -> Mesh:
    """Two arms with a common end, 100 and 90 long. The number of vertices is the nearest that a grid allows."""
    parts = min(range(1, 8), key=lambda k: abs(numpy.log(1160 * k * k / count)))  # 1160 at a grid of 5 units
    grid = numpy.indices((20 * parts, 18 * parts, 8 * parts))
    cells = (grid[0] < 9 * parts) | (grid[1] < 10 * parts)
    return of_cubes(cells, 5 / parts)


def plate_with_holes(_count: int = 0) -> Mesh:
    """A plate as CAD programs write it: faces of a few long triangles."""
    plate = manifold3d.Manifold.cube((110, 80, 22), True)
    for x, y, radius in ((-40, -28, 5), (40, -28, 5), (40, 28, 5), (-40, 28, 5), (-22, 0, 12)):
        plate -= manifold3d.Manifold.cylinder(60, radius, radius, 48, True).translate((x, y, 0))
    return mesh_of(plate)


# Features


@dataclass
class Feature:
    """A solid in its own frame: z = 0 is the surface of the model, z points outwards."""

    kind: str
    added: bool
    solid: manifold3d.Manifold
    #: The flat end that lies inside the model (added) or outside (removed); `None` without such an end.
    end: float | None = None


def ball(random: numpy.random.Generator, width: float, added: bool) -> Feature:
    """A ball whose circle in the plane z = 0 has this diameter. Its centre is above or below that plane."""
    offset = random.uniform(-0.5, 0.25) * (1 if added else -1)  # shares of the radius; undercuts stay gentle
    radius = width / 2 / numpy.sqrt(1 - offset**2)
    made = manifold3d.Manifold.sphere(radius, SEGMENTS).translate((0, 0, offset * radius))
    return Feature("sphere", added, made)


def prism(random: numpy.random.Generator, width: float, added: bool, section: Callable[[float], manifold3d.Manifold],
          kind: str) -> Feature:
    """`section` makes a solid of a height, with its lower end at z = 0."""
    height = random.uniform(0.5, 1) * width
    overlap = 0.5 * width  # so that the end stays beyond a curved surface
    made = section(height + overlap)
    low = -overlap if added else -height
    return Feature(kind, added, made.translate((0, 0, low)), -overlap if added else overlap)


def block(random: numpy.random.Generator, width: float, added: bool) -> Feature:
    other = random.uniform(0.75, 1) * width
    return prism(random, width, added,
                 lambda height: manifold3d.Manifold.cube((width, other, height)).translate((-width / 2, -other / 2, 0)),
                 "box")


def rod(random: numpy.random.Generator, width: float, added: bool) -> Feature:
    return prism(random, width, added,
                 lambda height: manifold3d.Manifold.cylinder(height, width / 2, width / 2, SEGMENTS), "cylinder")


def cone(random: numpy.random.Generator, width: float, added: bool) -> Feature:
    """A cone whose circle in the plane z = 0 has this diameter; the tip is cut off at up to a third of the height."""
    height = random.uniform(0.5, 1) * width
    overlap = 0.25 * width
    tip = random.uniform(0, 1 / 3)
    wide = width / 2 * (1 + overlap / height)
    made = manifold3d.Manifold.cylinder((1 - tip) * height + overlap, wide, tip * width / 2, SEGMENTS)
    made = made.translate((0, 0, -overlap))
    return Feature("cone", added, made if added else made.scale((1, 1, -1)), -overlap if added else overlap)


def through_hole(random: numpy.random.Generator, width: float, added: bool) -> Feature:
    del random, added
    made = manifold3d.Manifold.cylinder(400, width / 2, width / 2, SEGMENTS, True)
    return Feature("through-hole", False, made)


FEATURES: dict[str, Callable[[numpy.random.Generator, float, bool], Feature]] = {
    "sphere": ball, "box": block, "cylinder": rod, "cone": cone, "through-hole": through_hole}


def frame_of(normal: Array, turn: float) -> Array:
    """A rotation that takes z to the normal; its columns are the axes. `turn` is the angle about the normal."""
    helper = numpy.eye(3)[numpy.argmin(numpy.abs(normal))]
    x = numpy.cross(helper, normal)
    x /= numpy.linalg.norm(x)
    y = numpy.cross(normal, x)
    return numpy.column_stack([numpy.cos(turn) * x + numpy.sin(turn) * y, numpy.cos(turn) * y - numpy.sin(turn) * x,
                               normal])


def placed(solid: manifold3d.Manifold, frame: Array, position: Array) -> manifold3d.Manifold:
    return solid.transform(numpy.column_stack([frame, position]))
