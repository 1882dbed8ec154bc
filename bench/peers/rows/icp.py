# SPDX-License-Identifier: GPL-3.0-or-later
"""Refinement of a scan's pose against points with normals."""
from harness.row import Contender, Row, in_threads


def rows(inputs, large):
    mesh = inputs.scan("bunny", "meshes/bunny00.off")
    target, source = inputs.oriented(mesh), inputs.displaced(mesh, 50_000)
    prepare = {**target.load(), "points": source.load()["path"]}
    work = {"do": "icp", "max_distance": 5}
    return [
        Row(
            name="icp",
            title="Refinement of a pose, bunny, 1 degree and 1 % of the diagonal away",
            inputs=[target, source],
            contenders=[
                *in_threads([1, 2], "scanmill", work, prepare=prepare),
                Contender("open3d", work, "registration_icp", prepare=prepare),
            ],
            equal="the points and normals in memory, point to plane, a largest distance of 5 % of the diagonal, at most 50 "
            "iterations. The time includes the trees. Scanmill narrows the distance down to the noise, leaves outliers "
            "out, and ends when no point moves by 1/10,000 of the spacing; Open3D ends when fitness and residual "
            "change by less than 1e-9. Open3D always uses all cores. The result is the angle of the turn and the shift "
            "of the middle of the points.",
            agree={"angle": 1e-2, "shift": 1e-2},
            filters=["icp"],
        )
    ]
