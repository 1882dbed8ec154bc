# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the dihedral angles along the creases of a surface with those along the true creases, by length."""
import numpy
from crease_judge import samples_of_segments, segments
from scipy.spatial import cKDTree

#: Points per `aside` along the creases: the error of a point's position is at most an eighth of `aside`.
PER_ASIDE = 4


class Surface:
    """A mesh that gives the normals of the triangles nearest to points."""

    def __init__(self, vertices, triangles):
        import open3d

        corners = numpy.asarray(vertices, float)[triangles]
        across = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = numpy.linalg.norm(across, axis=1)
        kept = area > 0  # other triangles have no normal
        self._normals = across[kept] / area[kept, None]
        self._middle = numpy.mean(vertices, axis=0)  # Open3D stores floats
        self._scene = open3d.t.geometry.RaycastingScene()
        self._scene.add_triangles(numpy.asarray(vertices - self._middle, "f4"), numpy.asarray(triangles[kept], "u4"))

    def normals(self, points):
        found = self._scene.compute_closest_points(numpy.asarray(points - self._middle, "f4"))
        return self._normals[found["primitive_ids"].numpy()]


def sides(features):
    """The normals left and right of the segments of the creases, in the order of `segments`."""
    creases = [line for line in features["polylines"] if line["type"] == "crease"]
    return [numpy.reshape(numpy.array([normal for line in creases for normal in line[side]], float), (-1, 3))
            for side in ("left-normals", "right-normals")]


def corners(features):
    """Positions of the corners and of the ends of open creases."""
    ends = [line["points"][end] for line in features["polylines"] if not line["closed"] for end in (0, -1)]
    return numpy.reshape(numpy.array(features["corners"] + ends, float), (-1, 3))


def angles(surface, points, rows, features, aside):
    """The signed dihedral angles, in radians, at points on the segments `rows` of the creases: between the normals of
    the surface at the distance `aside` left and right of the crease. Convex angles are positive; 0 is flat."""
    starts, ends = segments(features)
    left, right = (normals[rows] for normals in sides(features))
    along = (ends - starts)[rows]
    along /= numpy.linalg.norm(along, axis=1)[:, None]
    left = surface.normals(points + aside * unit(numpy.cross(left, along)))
    right = surface.normals(points + aside * unit(numpy.cross(along, right)))
    is_concave = (numpy.cross(left, along) * right).sum(axis=1) > 0
    size = numpy.arctan2(numpy.linalg.norm(numpy.cross(left, right), axis=1), (left * right).sum(axis=1))
    return numpy.where(is_concave, -size, size)


def unit(vectors):
    length = numpy.linalg.norm(vectors, axis=1)[:, None]
    return vectors / numpy.where(length > 0, length, 1)


def judged(surface, found, model, true, away, aside, distance, largest):
    """Compares the dihedral angles of `surface` along the creases `found` with those of `model` along those of `true`.

    Counts are lengths of true creases that are at least `away` from every true corner: `length` is their sum, `near`
    the share that is within `distance` of a crease found, and `right` the share that is also within `largest` degrees
    of the true angle. `error` is the median difference of the angles where a crease is near, in degrees. Shares are
    None without such creases, and `error` without a near one.
    """
    step = aside / PER_ASIDE
    points, lengths, rows = samples_of_segments(segments(true), step)
    if len(points) and len(ends := corners(true)):
        kept = cKDTree(ends).query(points)[0] >= away
        points, lengths, rows = points[kept], lengths[kept], rows[kept]
    if not len(points):
        return {"length": 0.0, "near": None, "right": None, "error": None}
    lines, _, segment = samples_of_segments(segments(found), step)
    if not len(lines):
        return {"length": float(lengths.sum()), "near": 0.0, "right": 0.0, "error": None}
    gap, nearest = cKDTree(lines).query(points)
    near = gap <= distance
    wanted = angles(model, points[near], rows[near], true, aside)
    made = angles(surface, lines[nearest[near]], segment[nearest[near]], found, aside)
    error = numpy.degrees(abs(made - wanted))
    whole = lengths.sum()
    return {"length": float(whole), "near": float(lengths[near].sum() / whole),
            "right": float(lengths[near][error <= largest].sum() / whole),
            "error": float(numpy.median(error)) if len(error) else None}
