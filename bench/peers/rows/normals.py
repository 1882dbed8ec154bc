# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals from the nearest neighbours: by planes, by jets, and oriented along a spanning tree."""
from harness.row import Contender, Row, in_threads

NEIGHBOURS = 18


def rows(inputs, large):
    cloud = inputs.torus(350_000)
    return [
        row("normals-plane", "by planes", cloud, {}, others=[
            *in_threads([1, 2], "cgal", work(), label="pca_estimate_normals", prepare=cloud.load()),
            *in_threads([1, 2], "pcl", work(), label="NormalEstimationOMP", prepare=cloud.load()),
            Contender("open3d", work(), "estimate_normals", prepare=cloud.load()),
        ]),
        row("normals-jet", "by jets", cloud, {"jet": True}, others=[
            *in_threads([1, 2], "cgal", work(jet=True), label="jet_estimate_normals", prepare=cloud.load()),
        ]),
        row("normals-oriented", "by planes, oriented along a tree", cloud, {"oriented": True}, others=[
            *in_threads([1, 2], "cgal", work(oriented=True), label="mst_orient_normals", prepare=cloud.load()),
            Contender("open3d", work(oriented=True), "orient_normals_consistent_tangent_plane", prepare=cloud.load()),
        ]),
    ]


def work(**more):
    return {"do": "normals", "neighbours": NEIGHBOURS, **more}


def row(name, how, cloud, more, others):
    return Row(
        name=name,
        title=f"Normals {how}, from {NEIGHBOURS} neighbours",
        inputs=[cloud],
        contenders=[*in_threads([1, 2], "scanmill", work(**more), prepare=cloud.load()), *others],
        equal="the points in memory and the number of neighbours. The time includes the tree. PCL stores floats. Open3D "
        "always uses all cores. The result is the share of normals with x as their largest component, and where they are "
        "oriented the mean product of normal and point, which is positive if normals point outwards.",
        agree={"along_x": 1e-2, "flux": 1e-2},
        filters=["normals"],
    )
