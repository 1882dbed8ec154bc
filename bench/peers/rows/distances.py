# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances of points to a mesh: what every measure of a reconstruction asks for."""
from harness.row import Contender, Row, in_threads


def rows(inputs, large):
    bunny = inputs.scan("bunny", "meshes/bunny00.off")
    dragon = inputs.scan("dragon", "dragon/dragon_vrip.ply")
    return [
        row("distances-bunny", "points around the bunny", bunny, inputs.around(bunny, 100_000)),
        row("distances-dragon", "the coarser dragon's vertices to the dragon", dragon,
            inputs.scan("dragon-res2", "dragon/dragon_vrip_res2.ply")),
    ]


def row(name, what, mesh, points):
    prepare = {**mesh.load(), "points": points.load()["path"]}
    work = {"do": "distances"}
    return Row(
        name=name,
        title=f"Distances from points to a mesh, {what}",
        inputs=[mesh, points],
        contenders=[
            *in_threads([1, 2], "scanmill", work, prepare=prepare),
            Contender("cgal", work, "AABB_tree", prepare=prepare),
            *in_threads([1, 2], "open3d", work, label="RaycastingScene", prepare=prepare),
            Contender("pymeshlab", work, "get_hausdorff_distance", prepare=prepare),
            Contender("trimesh", work, "closest_point", prepare=prepare),
        ],
        equal="mesh and points in memory; building the search structure and asking for every point's distance. Ours "
        "and CGAL's work on doubles, Open3D's on floats.",
        agree={"mean": 1e-4, "rms": 1e-4, "max": 1e-4},
    )
