# SPDX-License-Identifier: GPL-3.0-or-later
"""Signed deviations of a scan from its nominal mesh, with statistics and a tolerance."""
from harness.row import Contender, Row, in_threads


def rows(inputs, large):
    bunny = inputs.scan("bunny", "meshes/bunny00.off")
    around = inputs.around(bunny, 3_500_000)
    prepare = {**bunny.load(), "points": around.load()["path"]}
    work = {"do": "inspect", "tolerance": 0.005, "max_distance": 1}
    return [
        Row(
            name="inspect-bunny",
            title="Signed deviations from a nominal mesh, 3.5 million points around the bunny",
            inputs=[bunny, around],
            contenders=[
                *in_threads([1, 2], "scanmill", work, prepare=prepare),
                *in_threads([1, 2], "open3d", work, label="compute_signed_distance", prepare=prepare),
            ],
            equal="the mesh and the points in memory. The time includes building the search structure, all queries, "
            "extremes, root mean square and the share in tolerance. Scanmill also chooses labels, counts points beyond "
            "borders and makes the map on the nominal. It uses doubles and the mesh's orientation; Open3D uses floats "
            "and counts crossings of a ray.",
            filters=["inspect"],
            agree={"rms": 1e-4, "min": 1e-4, "max": 1e-4, "in_tolerance": 1e-4},
        )
    ]
