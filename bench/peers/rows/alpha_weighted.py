# SPDX-License-Identifier: GPL-3.0-or-later
"""The alpha-solid of weighted points with an automatic radius, compared with the regular triangulation alone."""
from harness.row import Contender, Row, in_threads


def rows(inputs, large):
    return [
        row("alpha-weighted-bunny", "bunny", inputs.weighted(inputs.scan("bunny", "meshes/bunny00.off"))),
        row("alpha-weighted-torus", "bumpy torus", inputs.weighted(inputs.torus(350_000)), rounds=2),
    ]


def row(name, shape, cloud, **more):
    load = cloud.load()
    return Row(
        name=name,
        title=f"Alpha-solid of weighted points, {shape}",
        inputs=[cloud],
        contenders=[
            *in_threads([1, 2], "scanmill", {"do": "alpha-solid", "weighted": True}, prepare=load),
            Contender(
                "cgal", {"do": "regular"}, "Regular_triangulation_3", prepare=load,
                differs="stops after the triangulation, the first of the two steps; the ratio compares both "
                "steps with it.",
            ),
        ],
        equal="the points in memory and their weights, the squares of the local spacing. Scanmill reads the weights "
        "from a column.",
        agree={"cells": 0, "alpha": 0, "triangles": 0},
        filters=["delaunay", "alpha-solid"],
        peak_per="cells",
        **more,
    )
