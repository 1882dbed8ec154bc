# SPDX-License-Identifier: GPL-3.0-or-later
"""Smoothing of points onto jets of degree two."""
from harness.row import Row, in_threads

WORK = {"do": "smooth", "neighbours": 24}


def rows(inputs, large):
    cloud = inputs.torus(350_000)
    return [
        Row(
            name="smooth",
            title="Smoothing by jets of 24 neighbours",
            inputs=[cloud],
            contenders=[
                *in_threads([1, 2], "scanmill", WORK, prepare=cloud.load()),
                *in_threads([1, 2], "cgal", WORK, label="jet_smooth_point_set", prepare=cloud.load()),
            ],
            equal="the points in memory, the number of neighbours and the degree. The time includes the tree. The result "
            "is the root mean square of the points' movements.",
            agree={"moved_rms": 1e-3},
            filters=["smooth"],
        )
    ]
