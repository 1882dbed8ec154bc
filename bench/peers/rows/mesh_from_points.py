# SPDX-License-Identifier: GPL-3.0-or-later
"""From points to a mesh: tetrahedralisation, alpha-solid and sculpting, compared with the tetrahedralisation alone."""
from harness.row import Contender, Row, in_threads

BARE = "stops after the tetrahedralisation, the first of the three steps; the ratio compares all three with it"


def rows(inputs, large):
    found = [
        row("mesh-bunny", "bunny", inputs.scan("bunny", "meshes/bunny00.off")),
        row("mesh-torus", "bumpy torus", inputs.torus(350_000)),
        row("mesh-dragon", "dragon", inputs.scan("dragon", "dragon/dragon_vrip.ply")),
    ]
    if large:
        # One round of Scanmill takes half a minute and more than 3 gigabytes.
        torus = inputs.torus(3_500_000)
        more = {"warm_up": False, "rounds": 2, "grows_from": "mesh-torus"}
        found.append(row("mesh-large-torus", "large bumpy torus", torus, **more))
    return found


def row(name, shape, cloud, **more):
    load = cloud.load()
    return Row(
        name=name,
        title=f"From points to a sculpted mesh, {shape}",
        inputs=[cloud],
        contenders=[
            *in_threads([1, 2], "scanmill", {"do": "sculpt"}, prepare=load),
            Contender("cgal", {"do": "delaunay"}, "Delaunay_triangulation_3", prepare=load, differs=BARE),
        ],
        equal="the points in memory as doubles. Scanmill runs delaunay, alpha-solid with an automatic radius and "
        "sculpt in one process and delivers a mesh; CGAL makes no surface.",
        agree={"cells": 0, "alpha": 0, "triangles": 0, "removed": 0, "interior_points": 0},
        filters=["delaunay", "alpha-solid", "sculpt"],
        peak_per="cells",
        **more,
    )
