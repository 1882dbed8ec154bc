# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances from points to a mesh, as needed to measure a reconstruction."""
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
        equal="the mesh and the points in memory. The time includes building the search structure and all queries. "
        "Scanmill and CGAL use doubles, Open3D floats.",
        agree={"mean": 1e-4, "rms": 1e-4, "max": 1e-4},
    )
