# SPDX-License-Identifier: GPL-3.0-or-later
"""Delaunay tetrahedralisation."""
from harness.row import Contender, Row, in_threads


def rows(inputs, large):
    found = [
        row("delaunay-bunny", "bunny", inputs.scan("bunny", "meshes/bunny00.off")),
        row("delaunay-torus", "bumpy torus", inputs.torus(350_000)),
        row("delaunay-dragon", "dragon", inputs.scan("dragon", "dragon/dragon_vrip.ply")),
    ]
    if large:
        torus = inputs.torus(3_500_000)
        found.append(row("delaunay-large-torus", "large bumpy torus", torus, grows_from="delaunay-torus"))
    return found


def row(name, shape, cloud, **more):
    load = cloud.load()
    return Row(
        name=name,
        title=f"Delaunay tetrahedralisation, {shape}",
        inputs=[cloud],
        contenders=[
            *in_threads([1, 2], "scanmill", {"do": "delaunay"}, prepare=load),
            Contender("cgal", {"do": "delaunay"}, "Delaunay_triangulation_3", prepare=load),
            Contender("cgal", {"do": "delaunay", "parallel": True}, "with TBB", threads=2, prepare=load),
            # Qhull uses rounded arithmetic, so its flat cells may differ.
            Contender("scipy", {"do": "delaunay"}, "(qhull)", prepare=load, agree={"cells": 1e-3}),
        ],
        equal="the points in memory as doubles, and the cells. Scanmill also delivers them as arrays in canonical "
        "order with neighbours. CGAL keeps its own structure, whose destruction is not measured. The predicates of "
        "qhull are not exact.",
        agree={"cells": 0, "vertices": 0},
        filters=["delaunay"],
        peak_per="cells",
        **more,
    )
