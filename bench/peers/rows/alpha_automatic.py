# SPDX-License-Identifier: GPL-3.0-or-later
"""The alpha shape with its radius chosen automatically, from points."""
from harness.row import Contender, Row, in_threads


def rows(inputs, large):
    dragon = inputs.scan("dragon", "dragon/dragon_vrip.ply")
    return [
        row("alpha-automatic-bunny", "bunny", inputs.scan("bunny", "meshes/bunny00.off")),
        row("alpha-automatic-dragon", "dragon", dragon, warm_up=False, rounds=2),
        row("alpha-automatic-torus", "bumpy torus", inputs.torus(350_000), warm_up=False, rounds=2),
    ]


def row(name, shape, cloud, **more):
    load = cloud.load()
    return Row(
        name=name,
        title=f"Alpha shape with an automatic radius, {shape}",
        inputs=[cloud],
        contenders=[
            *in_threads([1, 2], "scanmill", {"do": "alpha-solid"}, prepare=load),
            Contender(
                "cgal", {"do": "optimal-alpha-shape"}, "find_optimal_alpha(1)", prepare=load,
                differs="seeks the least radius at which one solid of tetrahedra has every point on or in it; what thin "
                "walls enclose is no solid to it, so its radius is larger, and its boundary need be no manifold. "
                "Ours counts what walls enclose as solid and delivers a closed manifold.",
            ),
        ],
        equal="the points in memory; the tetrahedralisation and the choice count.",
        agree={"alpha": 0, "triangles": 0},
        **more,
    )
