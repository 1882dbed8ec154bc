# SPDX-License-Identifier: GPL-3.0-or-later
"""The alpha shape with an automatic radius, from points."""
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
                differs="finds the least radius at which one solid of tetrahedra contains every point. It does not "
                "count volume enclosed by thin walls as solid, so its radius is larger, and its boundary may be "
                "non-manifold. Scanmill counts enclosed volume as solid and delivers a closed manifold.",
            ),
        ],
        equal="the points in memory. The time includes the tetrahedralisation and the choice of the radius.",
        agree={"alpha": 0, "triangles": 0},
        filters=["delaunay", "alpha-solid"],
        **more,
    )
