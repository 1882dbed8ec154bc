# SPDX-License-Identifier: GPL-3.0-or-later
"""The alpha shape at a given radius, from points."""
from harness.row import Contender, Row, in_threads


def rows(inputs, large):
    return [
        row("alpha-given-bunny", "bunny", inputs.scan("bunny", "meshes/bunny00.off"), 0.0321),
        row("alpha-given-torus", "bumpy torus", inputs.torus(350_000), 0.0078),
        row("alpha-given-dragon", "dragon", inputs.scan("dragon", "dragon/dragon_vrip.ply"), 0.00172),
    ]


def row(name, shape, cloud, alpha):
    load, work = cloud.load(), {"alpha": alpha}
    return Row(
        name=name,
        title=f"Alpha shape of radius {alpha:g}, {shape}",
        inputs=[cloud],
        contenders=[
            *in_threads([1, 2], "scanmill", {"do": "alpha-solid", **work}, prepare=load),
            Contender("cgal", {"do": "fixed-alpha-shape", **work}, "Fixed_alpha_shape_3", prepare=load),
            Contender("open3d", {"do": "alpha-shape", **work}, prepare=load, agree={"regular_facets": 1e-3}),
        ],
        equal="the points in memory, the radius, the alpha complex. The time includes the tetrahedralisation. Scanmill "
        "delivers a mesh of the solid, with enclosed volume as part of it. CGAL only classifies every simplex; the "
        "triangles of its solid are counted after the measurement, for comparison. Open3D delivers the boundary of the "
        "cells with inner walls, compared with CGAL's; its cells come from qhull, whose predicates are not exact.",
        agree={"triangles": 0, "regular_facets": 0},
        filters=["delaunay", "alpha-solid"],
    )
