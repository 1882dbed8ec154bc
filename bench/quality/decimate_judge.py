# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures decimated meshes of all programs in the same way."""
import numpy

from tables import scanmill

#: The reported quantile of the triangles' minimum angles.
QUANTILE = 0.1


def minimum_angles(points, triangles):
    """The smallest angle of every triangle, in degrees; 0 for a degenerate triangle. `triangles`: n × 3 indices."""
    corners = numpy.asarray(points, float)[numpy.asarray(triangles, int)]
    smallest = numpy.full(len(corners), 180.0)
    for i in range(3):
        one, other = corners[:, i - 2] - corners[:, i], corners[:, i - 1] - corners[:, i]
        across, along = numpy.linalg.norm(numpy.cross(one, other), axis=1), (one * other).sum(axis=1)
        smallest = numpy.minimum(smallest, numpy.degrees(numpy.arctan2(across, along)))
    return smallest


def read(path):
    """Points and triangles of a mesh file, unchanged."""
    import trimesh

    mesh = trimesh.load(path, process=False)
    return mesh.vertices, mesh.faces


def judged(metrics, angles):
    """The facts of a mesh, from the metrics of `scanmill measure` and the minimum angles of its triangles."""
    facts = {
        "triangles": int(metrics["triangles"]),
        "self_intersections": int(metrics["self-intersections"]),
        "min_angle": round(float(numpy.quantile(angles, QUANTILE)), 3),
    }
    if "certified" in metrics:
        facts.update(lower=metrics["hausdorff-lower"], upper=metrics["hausdorff-upper"],
                     certified=bool(metrics["certified"]))
    return facts


class Judge:
    """`threads`: of one measurement; results do not depend on it."""

    def __init__(self, program, threads, limit):
        self.program, self.threads, self.limit = program, threads, limit

    def __call__(self, mesh, truth):
        """The facts of a mesh file, with the certified distance in both directions from the file `truth`. Raises
        scanmill.Broken if it cannot be measured."""
        return self._judged(mesh, truth, ["certify=true"])

    def alone(self, mesh):
        """The facts without the distance."""
        return self._judged(mesh, mesh, ["certify=false"])

    def _judged(self, mesh, truth, settings):
        metrics = scanmill.measure(self.program, mesh, truth, self.limit,
                                   [*settings, "samples=10000", "same-frame=true"], threads=self.threads)
        return judged(metrics, minimum_angles(*read(mesh)))
