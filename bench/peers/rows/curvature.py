# SPDX-License-Identifier: GPL-3.0-or-later
"""The local surface at every point, from its nearest neighbours."""
from harness.row import Contender, Row

NEIGHBOURS = 25


def rows(inputs, large):
    return [
        row("curvature-torus", "bumpy torus", inputs.torus(350_000)),
        row("curvature-dragon", "dragon", inputs.scan("dragon", "dragon/dragon_vrip.ply")),
    ]


def row(name, shape, cloud):
    load, work = cloud.load(), {"neighbours": NEIGHBOURS}
    contenders = []
    for threads in (1, 2):
        contenders.append(
            Contender("scanmill", {"do": "curvature", **work}, threads=threads, prepare=load)
        )
        contenders.append(
            Contender("pcl", {"do": "normals", **work}, "NormalEstimationOMP", threads=threads, prepare=load)
        )
    return Row(
        name=name,
        title=f"Surfaces from {NEIGHBOURS} neighbours, {shape}",
        inputs=[cloud],
        contenders=contenders,
        equal="the points in memory and the number of neighbours. The time includes the tree and the search for all "
        "points. Scanmill also fits a quadric to every neighbourhood and computes its normal and its principal "
        "curvatures; PCL computes normals only. Scanmill stores doubles, PCL floats.",
        agree={"along_x": 1e-2},
    )
