# SPDX-License-Identifier: GPL-3.0-or-later
"""Holes of a mesh, closed by triangles that continue the surface."""
from harness.row import Contender, Row, in_threads

WORK = {"do": "fill-holes"}
PLAIN = "spans the holes with triangles between their vertices: no refinement, no fairing"


def rows(inputs, large):
    mesh = inputs.holes(inputs.scan("bunny", "meshes/bunny00.off"), 100)
    load = mesh.load()
    return [
        Row(
            name="fill-holes",
            title="100 holes closed, bunny",
            inputs=[mesh],
            contenders=[
                *in_threads([1, 2], "scanmill", WORK, prepare=load),
                Contender("cgal", WORK, "triangulate_refine_and_fair_hole", prepare=load),
                Contender("pymeshlab", WORK, "meshing_close_holes", prepare=load, differs=PLAIN),
                Contender("vtk", WORK, "vtkFillHolesFilter", prepare=load, differs=PLAIN),
            ],
            equal="the mesh in memory. Scanmill also searches for intersections of the new triangles. CGAL's time "
            "includes the conversion to its own mesh.",
            agree={"boundary_edges": 0, "volume": 1e-3},
            filters=["fill-holes"],
        )
    ]
