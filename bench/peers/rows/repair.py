# SPDX-License-Identifier: GPL-3.0-or-later
"""A manifold of loose triangles: equal points joined, neighbours oriented equally."""
from harness.row import Contender, Row, in_threads

WORK = {"do": "repair"}


def rows(inputs, large):
    soup = inputs.soup(inputs.scan("bunny", "meshes/bunny00.off"))
    load = soup.load()
    return [
        Row(
            name="repair",
            title="A manifold of loose triangles, bunny",
            inputs=[soup],
            contenders=[
                *in_threads([1, 2], "scanmill", WORK, prepare=load),
                Contender("cgal", WORK, "repair_polygon_soup, orient_polygon_soup", prepare=load),
                Contender("pymeshlab", WORK, "re_orient_faces_coherently", prepare=load),
                Contender("vtk", WORK, "vtkCleanPolyData, vtkPolyDataNormals", prepare=load),
                Contender("trimesh", WORK, "merge_vertices, fix_winding", prepare=load),
            ],
            equal="the triangles in memory. All join equal points and orient neighbours equally. Scanmill and CGAL also "
            "split non-manifold edges and vertices. The results are the points, the edges with one triangle, and the "
            "volume enclosed, whichever side is outside.",
            agree={"points": 0, "boundary_edges": 0, "enclosed": 1e-5},
            filters=["repair"],
        )
    ]
