# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts for the bench of touched edges, as closed meshes in mm, and their true edges."""
import manifold3d
import numpy
import trimesh

#: Facets around a hole or a cone: a radius of 50 deviates by 0.4 µm.
FACETS = 720
#: Edges between faces whose normals differ by more than this are true edges; the finest models have facets of 5 degrees.
EDGE = numpy.radians(25)
#: Models are scaled to this diagonal, about that of the block.
DIAGONAL = 135.0


def mesh_of(solid):
    mesh = solid.to_mesh64()
    return trimesh.Trimesh(mesh.vert_properties[:, :3], mesh.tri_verts, process=False)


def block_with_holes(size=(88, 95, 41), middle=21, corner=5):
    """The block of the thesis's first case; it states the sizes but not where the small holes are."""
    solid = manifold3d.Manifold.cube(size, True)
    places = [(0, 0, middle)]
    places += [(x * 0.35 * size[0], y * 0.35 * size[1], corner) for x in (-1, 1) for y in (-1, 1)]
    for x, y, radius in places:
        hole = manifold3d.Manifold.cylinder(2 * size[2], radius, radius, FACETS, True)
        solid -= hole.translate((x, y, 0))
    return mesh_of(solid)


def bicone(radius=50, height=30):
    """Two cones with a common base, whose interior angle is 2 atan(height / radius), tilted so that most of the edge can be
    touched from above."""
    cone = manifold3d.Manifold.cylinder(height, radius, 0, FACETS)
    return mesh_of((cone + cone.mirror((0, 0, 1))).rotate((35, 10, 0)))


def flange(radius=48, thickness=14, hub=22, height=40, bore=12, bolts=6):
    """A disc with a hub, a bore, bolt holes and one flat side."""
    solid = manifold3d.Manifold.cylinder(thickness, radius, radius, FACETS)
    solid += manifold3d.Manifold.cylinder(height, hub, hub, FACETS)
    solid -= manifold3d.Manifold.cylinder(3 * height, bore, bore, FACETS, True)
    for i in range(bolts):
        hole = manifold3d.Manifold.cylinder(3 * height, 4.5, 4.5, FACETS, True)
        solid -= hole.translate((35, 0, 0)).rotate((0, 0, 360 * i / bolts))
    solid -= manifold3d.Manifold.cube((20, 4 * radius, 3 * height), True).translate((radius, 0, 0))
    return mesh_of(solid)


def model(file):
    mesh = trimesh.load(file, process=False)
    mesh.apply_scale(DIAGONAL / float(numpy.linalg.norm(mesh.extents)))
    return mesh


def true_edges(mesh):
    """Starts and ends of the segments where two faces meet at more than EDGE."""
    sharp = mesh.face_adjacency_edges[mesh.face_adjacency_angles > EDGE]
    return mesh.vertices[sharp[:, 0]], mesh.vertices[sharp[:, 1]]
