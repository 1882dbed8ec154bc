# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals of smooth surfaces through virtual scans, against the true ones.

The truth is a mesh that Loop's rule has subdivided, with vertex normals interpolated over its triangles.
"""
import numpy

#: Minimum number of triangles of a subdivided model.
LEAST = 150_000
SAMPLES = 15_000
#: Degrees beyond which an edge bends visibly.
VISIBLE = 5


class Truth:
    def __init__(self, file):
        import open3d
        import trimesh

        mesh = trimesh.load(file, process=False)
        mesh = trimesh.Trimesh(mesh.vertices, mesh.faces)
        while len(mesh.faces) < LEAST:
            mesh = mesh.subdivide_loop(1)
        self.mesh = mesh
        self.diagonal = float(numpy.linalg.norm(numpy.ptp(mesh.vertices, axis=0)))
        self.normals = numpy.asarray(mesh.vertex_normals)
        self.scene = open3d.t.geometry.RaycastingScene()
        self.scene.add_triangles(numpy.asarray(mesh.vertices, "f4"), numpy.asarray(mesh.faces, "u4"))

    def nearest(self, points):
        """The nearest points of the truth, and the normals there."""
        found = self.scene.compute_closest_points(numpy.asarray(points, "f4"))
        corners = self.mesh.faces[found["primitive_ids"].numpy()]
        u, v = found["primitive_uvs"].numpy().astype(float).T
        shares = numpy.stack([1 - u - v, u, v], axis=1)[:, :, None]
        normals = (self.normals[corners] * shares).sum(axis=1)
        normals /= numpy.linalg.norm(normals, axis=1)[:, None]
        return (self.mesh.vertices[corners] * shares).sum(axis=1), normals


def share_of_visible_edges(vertices, triangles):
    """Share of the edges that bend visibly, in percent."""
    import trimesh

    angles = trimesh.Trimesh(vertices, triangles, process=False).face_adjacency_angles
    return float(100 * (numpy.degrees(angles) > VISIBLE).mean())


def compared(truth, vertices, triangles, normals=None):
    """Angles to the true normals and distances from the truth at random points of a mesh. Without vertex
    normals, the triangles' are used."""
    import trimesh

    triangles = triangles[numpy.isfinite(vertices[triangles]).all(axis=(1, 2))]
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    points, faces, shares = sample(mesh)
    true_points, true_normals = truth.nearest(points)
    if normals is None:
        own = mesh.face_normals[faces]
    else:
        own = (normals[triangles[faces]] * shares[:, :, None]).sum(axis=1)
        own /= numpy.linalg.norm(own, axis=1)[:, None]
    angles = numpy.degrees(numpy.arccos(numpy.clip((own * true_normals).sum(axis=1), -1, 1)))
    distances = numpy.linalg.norm(points - true_points, axis=1)
    return {"angle": float(angles.mean()), "angle95": float(numpy.quantile(angles, 0.95)),
            "distance": float(numpy.sqrt((distances ** 2).mean())) / truth.diagonal}


def sample(mesh):
    """Points, their triangles and their shares of the corners, always the same ones."""
    random = numpy.random.default_rng(1)
    sums = numpy.cumsum(mesh.area_faces)
    faces = numpy.searchsorted(sums, random.random(SAMPLES) * sums[-1])
    u, v = random.random((2, SAMPLES))
    beyond = u + v > 1
    u[beyond], v[beyond] = 1 - u[beyond], 1 - v[beyond]
    shares = numpy.stack([1 - u - v, u, v], axis=1)
    return (mesh.triangles[faces] * shares[:, :, None]).sum(axis=1), faces, shares


def with_noise(truth, points, noise):
    """The points, moved along the true normals; `noise` is the standard deviation as a share of the diagonal."""
    _, normals = truth.nearest(points)
    amounts = numpy.random.default_rng(1).normal(0, noise * truth.diagonal, len(points))
    return points + amounts[:, None] * normals
