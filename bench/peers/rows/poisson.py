# SPDX-License-Identifier: GPL-3.0-or-later
"""Screened Poisson reconstruction."""
from harness.row import Contender, Row

WORK = {"do": "poisson", "depth": 9, "scale": 1.1}


def rows(inputs, large):
    cloud = inputs.oriented(inputs.scan("bunny", "meshes/bunny00.off"))
    load = cloud.load()
    return [
        Row(
            name="poisson",
            title="Poisson reconstruction at depth 9, bunny",
            inputs=[cloud],
            contenders=[
                Contender("scanmill", WORK, threads=1, prepare=load),
                Contender("pcl", WORK, prepare=load),
                Contender("open3d", WORK, prepare=load),
                Contender("pymeshlab", WORK, prepare=load),
            ],
            equal="the points and normals in memory, the depth, the scale of the cube and one thread. Scanmill calls PCL, "
            "then fills cracks, measures densities, and looks for surface far from all points. Not compared: the number "
            "of triangles, because every program has another version of the method.",
            agree={"volume": 5e-3},
            filters=["poisson"],
        )
    ]
