# SPDX-License-Identifier: GPL-3.0-or-later
"""A smooth surface through the vertices of a mesh, as triangles."""
from harness.row import Contender, Row, in_threads

SEGMENTS = 4


def rows(inputs, large):
    return [
        row("a-patch-bunny", "bunny", inputs.scan("bunny", "meshes/bunny00.off")),
        row("a-patch-armadillo", "armadillo", inputs.scan("armadillo", "meshes/armadillo.off")),
    ]


def row(name, shape, mesh):
    load, work = mesh.load(), {"do": "subdivide", "segments": SEGMENTS}
    return Row(
        name=name,
        title=f"A smooth surface through a mesh's vertices, {SEGMENTS} segments per edge, {shape}",
        inputs=[mesh],
        contenders=[
            *in_threads([1, 2], "scanmill", {"do": "a-patch", "segments": SEGMENTS}, prepare=load),
            Contender("vtk", work, "vtkButterflySubdivisionFilter", prepare=load),
            Contender("pymeshlab", work, "meshing_surface_subdivision_butterfly", prepare=load),
        ],
        equal="the mesh in memory and the segments per edge. Scanmill makes tetrahedra with a cubic polynomial each and "
        "cuts their zero set into triangles, more of them because the surface also crosses the tetrahedra beside edges. "
        "Where these surfaces intersect, Scanmill repeats its work with straighter edges. The others interpolate the "
        "vertices by subdivision, without a formula for the surface. The surfaces differ, so the numbers of triangles are "
        "shown but not compared.",
        agree={},
        rounds=3,
        filters=["a-patch", "tessellate"],
    )
