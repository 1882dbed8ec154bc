# SPDX-License-Identifier: GPL-3.0-or-later
"""Seeded cases for mesh-update: a model, a feature that is added or removed, and a scan of the change alone.

The truth T is the model's polyhedron with the feature, by an exact boolean. A cloud has evenly spread points of T: all
of the change, and a ring of the unchanged model around it. Its points get a common translation and independent noise.
"""
from __future__ import annotations

import functools
import pathlib
import sys
from dataclasses import dataclass

import manifold3d
import numpy
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH / "robustness"), str(BENCH / "quality")]

import update_solids as solids  # noqa: E402
from update_solids import Array, Feature, Indices, Mesh  # noqa: E402

#: Points per spacing² of evenly spread points, the spacing being the median distance of nearest neighbours.
PER_SQUARE = 0.70
#: Least distance of evenly spread points, in median distances of nearest neighbours.
LEAST = 0.94
#: Candidates per point that is kept.
TRIED = 16
#: Longest link of points along the surface, in least distances; walls are much thicker.
LINK = 2.2
#: Width of the bands at the rim, and the longest link in them, in spacings.
BAND, JOIN = 2.0, 2.8
RING = (4.0, 8.0)  #: width of the ring, in spacings
WIDTH = (8.0, 70.0)  #: of the feature, in spacings
POINTS = (300, 10_000)
VERTICES = (1_000, 30_000)
SIZES = 9  #: numbers of vertices between these
RATIO = 16.0  #: densities differ by at most this factor
LOW_NOISE, NOISE = 0.1, 0.3  #: largest standard deviations, in spacings
SHIFT = 0.5  #: largest translation, in spacings
TILT = numpy.radians(15)  #: largest angle between feature and normal
LARGEST_SHARE = 0.4  #: of the model's area that a cloud may cover
THICKEST_SHARE = 0.5  #: width of a feature, of the model's shortest extent
#: Walls are at least this many spacings thick, of the coarser sampling on their sides.
WALL = 4.0
#: Share of the cloud that may lie on thinner walls: beside convex edges every wall is thin.
THIN_SHARE = 0.05
PARTS = 40  #: longest triangles of a search for the nearest one, per extent of the mesh
END = 1e-6  #: a corner this near the end of a feature belongs to it
DRAWS = 600


class Unsuitable(Exception):
    """This draw is not a case: drawn again."""


@dataclass
class Model:
    name: str
    kind: str  #: one of KINDS
    mesh: Mesh


KINDS = ("smooth", "meshed with edges", "CAD", "tight cocone")
#: Models by formula: kind, and the function that makes one of about so many vertices.
FORMULAS = {
    "sphere": ("smooth", solids.sphere),
    "ellipsoid": ("smooth", lambda count: solids.ellipsoid(count, (50, 38, 28))),
    "torus": ("smooth", solids.torus),
    "cylinder": ("meshed with edges", solids.cylinder),
    "l-block": ("meshed with edges", solids.l_block),
    "box": ("CAD", solids.box_of_12),
    "plate": ("CAD", solids.plate_with_holes),
}


@dataclass
class Cloud:
    clean: Array  #: points of T
    points: Array  #: the same with the errors
    ring: Array  #: for each point, the distance from the change along the surface
    dense: Array  #: many more points of T in the region
    spacing: float  #: h, the median distance of nearest neighbours in `clean`


@dataclass
class Case:
    index: int
    seed: int
    model: Model
    feature: str
    added: bool
    truth: Mesh
    cloud: Cloud
    position: Array
    width: float
    ring: float
    ratio: float | None  #: points per area of the cloud to vertices per area of the model; CAD models: None
    sigma: float  #: noise in spacings
    shift: float  #: translation in spacings

    def facts(self) -> dict:
        """The values that define the case, for the results."""
        return {"index": self.index, "model": self.model.name, "kind": self.model.kind, "feature": self.feature,
                "added": self.added, "vertices": self.model.mesh.used, "points": len(self.cloud.points),
                "h": self.cloud.spacing, "width": self.width / self.cloud.spacing,
                "ring": self.ring / self.cloud.spacing,
                "ratio": self.ratio, "sigma": self.sigma, "shift": self.shift, "euler": self.truth.euler,
                "position": [round(float(x), 3) for x in self.position]}


@dataclass
class Change:
    truth: manifold3d.Manifold
    mesh: Mesh  #: of the truth
    gone: Mesh  #: the model's faces that the truth does not have
    origins: list[int]  #: of the faces that the model does not have

    def changed(self) -> Mesh:
        return self.mesh.part(numpy.isin(self.mesh.origin, self.origins))


# Points


def uniform(mesh: Mesh, count: int, random: numpy.random.Generator) -> tuple[Array, Indices]:
    """Random points, uniform by area, and their faces."""
    weights = mesh.areas
    chosen = random.choice(len(weights), count, p=weights / weights.sum())
    root, along = numpy.sqrt(random.random((count, 1))), random.random((count, 1))
    a, b, c = (corner[chosen] for corner in mesh.corners())
    return (1 - root) * a + root * (1 - along) * b + root * along * c, chosen


def thinned(places: Array, least: float) -> numpy.ndarray:
    """Which places stay: each one that is at least this far from all earlier ones that stay. In parallel rounds: a
    round accepts every undecided place without an undecided earlier neighbour, and rejects its neighbours."""
    one, other = cKDTree(places).query_pairs(least, output_type="ndarray").T
    undecided, stays = numpy.ones(len(places), bool), numpy.zeros(len(places), bool)
    while undecided.any():
        first = undecided.copy()
        first[other] = False
        stays |= first
        gone = numpy.zeros(len(places), bool)
        gone[other[first[one]]] = True
        undecided &= ~first & ~gone
        left = undecided[one] & undecided[other]
        one, other = one[left], other[left]
    return stays


def median_nearest(points: Array) -> float:
    return float(numpy.median(cKDTree(points).query(points, 2)[0][:, 1]))


def along_surface(points: Array, begin: numpy.ndarray, link: float) -> Array:
    """The distance of every point from those of `begin`, on ways from point to point."""
    edges = cKDTree(points).query_pairs(link, output_type="ndarray")
    length = numpy.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    graph = coo_matrix((length, (edges[:, 0], edges[:, 1])), shape=(len(points),) * 2).tocsr()
    return dijkstra(graph, directed=False, indices=numpy.flatnonzero(begin), min_only=True)


def pieces(points: Array, link: float) -> int:
    """The connected components of points whose links are at most this long."""
    return solids.components(len(points), cKDTree(points).query_pairs(link, output_type="ndarray"))


def scan_of_change(change: Change, spacing: float, ring: float, rims: int, random: numpy.random.Generator,
                   most: int = POINTS[1]) -> Cloud:
    """Evenly spread points of the change and of the ring around it, without errors. `rims` is the number of rims that
    the cloud must have."""
    least = LEAST * spacing
    margin = ring + (2 + BAND) * spacing
    reach = numpy.concatenate([part.vertices[part.faces].reshape(-1, 3) for part in (change.changed(), change.gone)])
    low, high = reach.min(axis=0) - margin, reach.max(axis=0) + margin
    region = manifold3d.Manifold.cube(tuple(high - low)).translate(tuple(low))
    cut = solids.origins(region)
    near = solids.mesh_of(change.truth ^ region)
    near = near.part(~numpy.isin(near.origin, list(cut)))
    count = int(PER_SQUARE * near.area / spacing**2)
    if count > 3 * most:
        raise Unsuitable("large region")
    places, faces = uniform(near, TRIED * count, random)
    stays = numpy.flatnonzero(thinned(places, least))
    points = places[stays]
    begin = numpy.isin(near.origin[faces[stays]], change.origins)
    if begin.sum() < 30:
        raise Unsuitable("few points of the change")
    distance = along_surface(points, begin, LINK * least)
    inside = distance <= ring
    if not POINTS[0] <= inside.sum() <= most:
        raise Unsuitable("number of points")
    outermost = points[inside & (distance > ring - BAND * spacing)]
    beyond = points[(distance > ring + spacing) & (distance <= ring + (1 + BAND) * spacing)]
    join = JOIN * spacing
    if pieces(points[inside], join) != 1 or pieces(outermost, join) != rims or pieces(beyond, join) != rims:
        raise Unsuitable("rims")
    if len(beyond) < 0.7 * len(outermost):  # the rim nearly meets itself
        raise Unsuitable("pinched")
    _, owner = cKDTree(points).query(places)
    dense = places[inside[owner]]
    dense = dense[random.permutation(len(dense))[:40_000]]
    order = random.permutation(int(inside.sum()))
    clean = points[inside][order]
    return Cloud(clean, clean, distance[inside][order], dense, median_nearest(clean))


def with_errors(cloud: Cloud, sigma: float, shift: float, random: numpy.random.Generator) -> Cloud:
    """The cloud with noise and a translation, both in spacings."""
    direction = random.normal(size=3)
    moved = cloud.clean + shift * cloud.spacing * direction / numpy.linalg.norm(direction)
    moved = moved + sigma * cloud.spacing * random.normal(size=moved.shape)
    return Cloud(cloud.clean, moved, cloud.ring, cloud.dense, cloud.spacing)


# Distances


def scene_of(mesh: Mesh):
    import open3d

    scene = open3d.t.geometry.RaycastingScene(nthreads=1)  # two cases run at a time
    scene.add_triangles(numpy.ascontiguousarray(mesh.vertices, "f4"), numpy.ascontiguousarray(mesh.faces, "u4"))
    return scene


def distances(mesh: Mesh, points: Array) -> Array:
    """The distances of points from the mesh. The nearest triangle is found in float, which fails for long triangles, so
    those are divided; its distance is computed in double."""
    import trimesh

    longest = mesh.extents.max() / PARTS
    if mesh.longest_edge > longest:
        mesh = solids.mesh_of(solids.solid_of(mesh).refine_to_length(longest))
    found = scene_of(mesh).compute_closest_points(numpy.ascontiguousarray(points, "f4"))["primitive_ids"].numpy()
    nearest = trimesh.triangles.closest_point(mesh.vertices[mesh.faces[found.astype(int)]], points)
    return numpy.linalg.norm(nearest - points, axis=1)


def wall_thickness(mesh: Mesh, points: Array) -> Array:
    """The way from each point inwards along the normal to the other side."""
    scene = scene_of(mesh)
    faces = scene.compute_closest_points(numpy.ascontiguousarray(points, "f4"))["primitive_ids"].numpy().astype(int)
    inward = -mesh.normals[faces]
    size = float(mesh.extents.max())
    begin = points + 1e-4 * size * inward
    rays = numpy.concatenate([begin, inward], axis=1).astype("f4")
    return scene.cast_rays(rays)["t_hit"].numpy().astype(float)


# Drawing


@functools.lru_cache(maxsize=32)
def by_formula(name: str, step: int) -> Model:
    """The model with a number of vertices from a geometric series of SIZES steps."""
    kind, make = FORMULAS[name]
    return Model(name, kind, make(round(numpy.exp(numpy.linspace(*numpy.log(VERTICES), SIZES)[step]))))


def drawn_model(name: str, prebuilt: dict[str, list[Model]], random: numpy.random.Generator) -> Model:
    if name in prebuilt:
        return prebuilt[name][random.integers(len(prebuilt[name]))]
    return by_formula(name, int(random.integers(SIZES)))


def turned(mesh: Mesh, random: numpy.random.Generator) -> Mesh:
    """The mesh in a random position, so that neither axes nor rounding are special."""
    frame = numpy.linalg.qr(random.normal(size=(3, 3)))[0]
    frame[:, 0] *= numpy.linalg.det(frame)
    return Mesh(mesh.vertices @ frame.T + random.uniform(-50, 50, 3), mesh.faces)


def surface_normal(mesh: Mesh, position: Array, face: int, radius: float) -> Array:
    """The mean normal near the position, of faces on the same side."""
    middle = mesh.vertices[mesh.faces].mean(axis=1)
    normals = mesh.normals
    near = (numpy.linalg.norm(middle - position, axis=1) < radius) & (normals @ normals[face] > 0.5)
    near[face] = True
    mean = (normals[near] * mesh.areas[near][:, None]).sum(axis=0)
    return mean / numpy.linalg.norm(mean)


def tilted(normal: Array, random: numpy.random.Generator) -> Array:
    frame = solids.frame_of(normal, 0)
    angle, around = random.uniform(0, TILT), random.uniform(0, 2 * numpy.pi)
    return frame @ numpy.array([numpy.sin(angle) * numpy.cos(around), numpy.sin(angle) * numpy.sin(around),
                                numpy.cos(angle)])


def combined(body: manifold3d.Manifold, feature: Feature, frame: Array, position: Array) -> Change:
    """The model with the feature. Raises Unsuitable unless one part of the model's surface is replaced by one new
    part that has the same rim; of a through-hole, two parts."""
    through = feature.kind == "through-hole"
    tool = solids.placed(feature.solid, frame, position)
    origins = list(solids.origins(tool))
    gone = solids.mesh_of(body ^ tool)
    gone = gone.part(~numpy.isin(gone.origin, origins))
    if solids.face_components(gone.faces) != (2 if through else 1):
        raise Unsuitable("components of the change")
    truth = body + tool if feature.added else body - tool
    if len(truth.decompose()) != 1:
        raise Unsuitable("components")
    if truth.genus() != body.genus() + (1 if through else 0):
        raise Unsuitable("topology")
    made = Change(truth, solids.mesh_of(truth), gone, origins)
    changed = made.changed()
    if solids.face_components(changed.faces) != 1:
        raise Unsuitable("components of the change")
    if feature.end is not None:
        height = (changed.vertices[changed.faces].reshape(-1, 3) - position) @ frame[:, 2]
        if numpy.abs(height - feature.end).min() < END:
            raise Unsuitable("the end of the feature is visible")
    return made


def attempt(index: int, seed: int, prebuilt: dict[str, list[Model]], name: str, feature_name: str, ratio: float,
            sigma: float, random: numpy.random.Generator) -> Case:
    model = drawn_model(name, prebuilt, random)
    extent = float(model.mesh.extents.min())
    cad = model.kind == "CAD"
    area = model.mesh.area
    if cad:
        width = random.uniform(0.15, THICKEST_SHARE) * extent * (2 if name == "plate" else 1)
        spacing = width / numpy.exp(random.uniform(*numpy.log(WIDTH)))
    else:
        spacing = float(numpy.sqrt(PER_SQUARE * area / (ratio * model.mesh.used)))
        width = spacing * numpy.exp(random.uniform(*numpy.log(WIDTH)))
        if width > THICKEST_SHARE * extent:
            raise Unsuitable("wide")
    ring = random.uniform(*RING) * spacing
    around = numpy.pi * (width / 2 + ring) ** 2
    if around > LARGEST_SHARE * area or not 0.6 * POINTS[0] < PER_SQUARE * around / spacing**2 < POINTS[1]:
        raise Unsuitable("size")
    mesh = turned(model.mesh, random)
    added = bool(random.integers(2))
    feature = solids.FEATURES[feature_name](random, width, added)
    places, faces = uniform(mesh, 1, random)
    normal = tilted(surface_normal(mesh, places[0], int(faces[0]), width / 2), random)
    frame = solids.frame_of(normal, random.uniform(0, 2 * numpy.pi))
    change = combined(solids.solid_of(mesh), feature, frame, places[0])
    rims = 2 if feature_name == "through-hole" else 1
    cloud = scan_of_change(change, spacing, ring, rims, random)
    made = change.mesh
    if len(cloud.points) * cloud.spacing**2 / PER_SQUARE > LARGEST_SHARE * made.area:
        raise Unsuitable("large share")
    coarser = max(cloud.spacing, 0 if cad else model.mesh.median_edge)
    if (wall_thickness(made, cloud.clean) < WALL * coarser).mean() > THIN_SHARE:
        raise Unsuitable("thin wall")
    cloud = with_errors(cloud, sigma, random.uniform(0, SHIFT), random)
    measured = None if cad else PER_SQUARE / cloud.spacing**2 / (model.mesh.used / area)
    shift = float(numpy.linalg.norm((cloud.points - cloud.clean).mean(axis=0)) / cloud.spacing)
    return Case(index, seed, Model(model.name, model.kind, mesh), feature_name, feature.added, made, cloud, places[0],
                width, ring, measured, sigma, shift)


def case_of(seed: int, index: int, prebuilt: dict[str, list[Model]]) -> tuple[Case, dict[str, int]]:
    """The case with this index, and how often draws were unsuitable, by reason. Even indices have little noise."""
    random = numpy.random.default_rng([seed, index])
    names = [*FORMULAS, *prebuilt]
    ratio = RATIO ** random.uniform(-1, 1)
    sigma = random.uniform(0, LOW_NOISE) if index % 2 == 0 else random.uniform(LOW_NOISE, NOISE)
    name = names[random.integers(len(names))]
    reasons: dict[str, int] = {}
    for draw in range(DRAWS):
        if draw % 60 == 0:  # a feature that does not fit this model at this density
            feature = list(solids.FEATURES)[random.integers(len(solids.FEATURES))]
            if draw:
                name = names[random.integers(len(names))]
        try:
            return attempt(index, seed, prebuilt, name, feature, ratio, sigma, random), reasons
        except Unsuitable as unsuitable:
            reasons[str(unsuitable)] = reasons.get(str(unsuitable), 0) + 1
    raise RuntimeError(f"case {index}: {DRAWS} draws were unsuitable: {reasons}")
