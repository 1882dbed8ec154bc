# SPDX-License-Identifier: GPL-3.0-or-later
"""An open surface through points: region-grow and cluster-mesh compared with two methods of other libraries."""
from harness.row import Contender, Row, in_threads

#: PCL's search radius: five spacings.
RADII = {"torus": 0.026, "dragon": 0.0012, "large-torus": 0.0082}


def rows(inputs, large):
    found = [
        row("region-grow-torus", "bumpy torus", inputs.torus(350_000), RADII["torus"]),
        row("region-grow-dragon", "dragon", inputs.scan("dragon", "dragon/dragon_vrip.ply"), RADII["dragon"]),
    ]
    if large:
        torus = inputs.torus(3_500_000)
        more = {"warm_up": False, "rounds": 2, "grows_from": "region-grow-torus"}
        found.append(row("region-grow-large-torus", "large bumpy torus", torus, RADII["large-torus"], **more))
    return found


def row(name, shape, cloud, radius, **more):
    load = cloud.load()
    greedy = {"do": "greedy-projection", "radius": radius}
    return Row(
        name=name,
        title=f"A surface grown over points, {shape}",
        inputs=[cloud],
        contenders=[
            *in_threads([1, 2], "scanmill", {"do": "region-grow"}, label="region-grow", prepare=load),
            *in_threads([1, 2], "scanmill", {"do": "cluster-mesh"}, label="cluster-mesh", prepare=load),
            Contender("pcl", greedy, "GreedyProjectionTriangulation", prepare=load),
            Contender("cgal", {"do": "advancing-front"}, "advancing_front_surface_reconstruction", prepare=load),
        ],
        equal="the points in memory, without normals. Scanmill and PCL estimate normals from the neighbours; "
        "cluster-mesh makes edges below 2.5 spacings and ends with flips of edges; PCL searches within five spacings "
        "for its triangles; CGAL tetrahedralises. The surfaces differ, so the numbers of triangles and of unused points "
        "are shown but not compared.",
        agree={},
        filters=["region-grow", "cluster-mesh"],
        peak_per="triangles",
        **more,
    )
