# SPDX-License-Identifier: GPL-3.0-or-later
"""The distance between two meshes in both directions, and their areas."""
from harness.row import Contender, Row, in_threads

WORK = {"do": "measure", "samples": 100_000}


def rows(inputs, large):
    mesh = inputs.scan("dragon-res2", "dragon/dragon_vrip_res2.ply")
    truth = inputs.scan("dragon", "dragon/dragon_vrip.ply")
    prepare = {**mesh.load(), "points": truth.load()["path"]}
    return [
        Row(
            name="measure",
            title="The coarser dragon measured against the dragon",
            inputs=[mesh, truth],
            contenders=[
                *in_threads([1, 2], "scanmill", WORK, prepare=prepare),
                *in_threads([1, 2], "open3d", WORK, label="RaycastingScene", prepare=prepare),
                Contender("pymeshlab", WORK, "get_hausdorff_distance", prepare=prepare),
            ],
            equal="both meshes in memory and 100,000 samples in each direction. The time includes search structures and "
            "samples. Scanmill also measures all vertices, quantiles, precision, recall, normals, topology and angles, and "
            "searches the largest distance; PyMeshLab also topology; Open3D only distances and area. Samples differ, so "
            "the means agree within their spread.",
            agree={"mean": 2e-2, "area": 1e-5},
            filters=["measure"],
        )
    ]
