# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth closed surfaces with known normals: a body with limbs, an ellipsoid with bumps, a wobbly torus.

Each is the zero set of a function that is negative inside. dense() samples it by marching cubes, moves the vertices
onto the surface, evens them, and adds noise along the normals.
"""
import numpy
import pymeshlab

SHAPES = ("limbs", "bumps", "torus")
#: Centres and radii of chains of Gaussians: a body, two arms, two legs, a head with ears.
CHAINS = [((-0.6, 0, 0), (0.6, 0.1, 0), 0.42, 0.38), ((0.5, 0.1, 0.2), (0.9, 0.2, 0.9), 0.2, 0.12),
          ((0.5, 0.1, -0.2), (0.95, 0.5, -0.8), 0.2, 0.12), ((-0.5, -0.1, 0.2), (-0.8, -0.8, 0.5), 0.2, 0.14),
          ((-0.5, -0.1, -0.2), (-0.6, -0.9, -0.4), 0.22, 0.14), ((-0.7, 0.1, 0), (-1.2, 0.5, 0.05), 0.2, 0.22),
          ((-1.25, 0.6, 0.15), (-1.3, 0.8, 0.25), 0.1, 0.07), ((-1.25, 0.6, -0.1), (-1.2, 0.85, -0.2), 0.1, 0.07)]
PER_CHAIN = 9


def gaussians():
    for start, end, first, last in CHAINS:
        for share in numpy.linspace(0, 1, PER_CHAIN):
            yield (1 - share) * numpy.array(start) + share * numpy.array(end), (1 - share) * first + share * last


def value(shape, points):
    x, y, z = numpy.asarray(points, float).T
    if shape == "limbs":
        total = numpy.zeros(len(x))
        for centre, radius in gaussians():
            total += numpy.exp(-((x - centre[0]) ** 2 + (y - centre[1]) ** 2 + (z - centre[2]) ** 2) / radius ** 2)
        return -numpy.log(total + 1e-12)
    if shape == "bumps":
        return numpy.sqrt(x ** 2 + (y / 0.75) ** 2 + (z / 0.6) ** 2) - 1 \
            - 0.05 * numpy.sin(7 * x) * numpy.sin(6 * y + 0.5) * numpy.cos(7 * z)
    angle = numpy.arctan2(y, x)
    tube = 0.32 + 0.05 * numpy.cos(5 * angle) + 0.03 * numpy.sin(3 * angle + 4 * z)
    return numpy.sqrt((numpy.hypot(x, y) - 1 - 0.06 * numpy.sin(2 * angle)) ** 2
                      + (z - 0.08 * numpy.cos(3 * angle)) ** 2) - tube


def gradient(shape, points):
    points = numpy.asarray(points, float)
    step = 1e-5
    return numpy.stack([(value(shape, points + step * axis) - value(shape, points - step * axis)) / (2 * step)
                        for axis in numpy.eye(3)], axis=1)


def normals(shape, points):
    found = gradient(shape, points)
    return found / numpy.linalg.norm(found, axis=1)[:, None]


def on_surface(shape, points):
    for _ in range(8):
        slope = gradient(shape, points)
        points = points - slope * (value(shape, points) / (slope ** 2).sum(1))[:, None]
    return points


def expression(shape):
    """The function for PyMeshLab's parser, which has a name for atan2 but not for numpy's functions."""
    if shape == "limbs":
        terms = "+".join(f"exp(-((x-({c[0]:.9g}))^2+(y-({c[1]:.9g}))^2+(z-({c[2]:.9g}))^2)/{r * r:.9g})"
                         for c, r in gaussians())
        return f"-ln({terms}+1e-12)"
    if shape == "bumps":
        return "sqrt(x^2+(y/0.75)^2+(z/0.6)^2)-1-0.05*sin(7*x)*sin(6*y+0.5)*cos(7*z)"
    angle = "atan2(y,x)"
    return (f"sqrt((sqrt(x^2+y^2)-1-0.06*sin(2*{angle}))^2+(z-0.08*cos(3*{angle}))^2)"
            f"-(0.32+0.05*cos(5*{angle})+0.03*sin(3*{angle}+4*z))")


def evened(shape, points, triangles, rounds=12):
    count = numpy.zeros(len(points))
    for i in range(3):
        numpy.add.at(count, triangles[:, i], 2)
    for _ in range(rounds):
        total = numpy.zeros_like(points)
        for i in range(3):
            for j in (1, 2):
                numpy.add.at(total, triangles[:, i], points[triangles[:, (i + j) % 3]])
        way = total / count[:, None] - points
        up = normals(shape, points)
        points = on_surface(shape, points + 0.5 * (way - up * (way * up).sum(1)[:, None]))
    return points


def dense(shape, cell, noise=0, seed=0):
    """Vertices and triangles of a mesh with edges of about `cell`; `noise` in percent of the diagonal."""
    meshes = pymeshlab.MeshSet()
    meshes.create_implicit_surface(voxelsize=cell, minx=-2, miny=-2, minz=-2, maxx=2, maxy=2, maxz=2,
                                   expr=expression(shape))
    meshes.meshing_merge_close_vertices()
    meshes.meshing_remove_duplicate_faces()
    meshes.meshing_remove_null_faces()
    meshes.meshing_remove_unreferenced_vertices()
    mesh = meshes.current_mesh()
    points, triangles = mesh.vertex_matrix().copy(), mesh.face_matrix().copy()
    points = evened(shape, on_surface(shape, points), triangles)
    corners = points[triangles]
    volume = numpy.einsum("ij,ij->i", corners[:, 0], numpy.cross(corners[:, 1], corners[:, 2])).sum() / 6
    if volume < 0:
        triangles = triangles[:, ::-1]
    size = numpy.linalg.norm(points.max(0) - points.min(0))
    random = numpy.random.default_rng(seed)
    points = points + normals(shape, points) * (random.normal(0, noise / 100 * size, len(points)))[:, None]
    return points, triangles
