# SPDX-License-Identifier: GPL-3.0-or-later
"""Voxel thinning to about a tenth of the points."""
from harness.row import Contender, Row, in_threads

#: Edges of the voxels, exactly representable as float.
SIZES = {350_000: 27 / 1024, 3_500_000: 17 / 2048}
CENTROID = "computes the centroid of each voxel, which is not a point of the scan and has none of its columns"


def rows(inputs, large):
    return [row(inputs.random_torus(count), count, size) for count, size in SIZES.items()]


def row(cloud, count, size):
    load, work = cloud.load(), {"bin_size": size}
    return Row(
        name=f"voxel-thin-{count // 1000}k",
        title=f"Voxel thinning, {count:,} points, voxels of {size:.5g}",
        inputs=[cloud],
        contenders=[
            *in_threads([1, 2], "scanmill", {"do": "voxel-thin", **work}, prepare=load),
            Contender("pcl", {"do": "uniform-sampling", **work}, "UniformSampling", prepare=load),
            Contender("pcl", {"do": "voxel-grid", **work}, "VoxelGrid", prepare=load, differs=CENTROID),
            Contender(
                "open3d", {"do": "voxel-thin", **work}, "voxel_down_sample", prepare=load,
                differs=f"{CENTROID}; its grid begins half a voxel below the bounding box of the points",
            ),
        ],
        equal="the points in memory and the grid (voxels begin at multiples of their size); every voxel keeps the "
        "point nearest its centre. Scanmill stores doubles and PCL floats, so points on the boundary of a voxel may "
        "differ.",
        agree={"kept": 1e-3},
        filters=["voxel-thin"],
    )
