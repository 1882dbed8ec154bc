# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlier removal by the mean distances to the nearest points."""
from harness.row import Contender, Row, in_threads

WORK = {"do": "remove-outliers", "neighbours": 16, "factor": 3}
#: About the share that the mean plus three standard deviations excludes here.
PERCENT = 0.8


def rows(inputs, large):
    cloud = inputs.random_torus(1_000_000)
    load = cloud.load()
    return [
        Row(
            name="outlier-removal-1m",
            title="Outlier removal with 16 neighbours and 3 standard deviations, 1,000,000 points",
            inputs=[cloud],
            contenders=[
                *in_threads([1, 2], "scanmill", {**WORK, "min_component": 0}, "min-component: 0", prepare=load),
                *in_threads(
                    [1, 2], "scanmill", {**WORK, "min_component": 0.1}, "defaults", prepare=load,
                    differs="keeps suspects that are connected to the scan",
                ),
                Contender("pcl", WORK, "StatisticalOutlierRemoval", prepare=load),
                *in_threads(
                    [1, 2], "cgal", {**WORK, "percent": PERCENT}, "remove_outliers", prepare=load,
                    differs="removes a given percentage of the points, those with the largest mean squared distances",
                ),
            ],
            equal="the points in memory, the number of neighbours and the factor. The time includes the tree and the "
            "copy of the kept points. Scanmill stores doubles and PCL floats, so points at the limit may differ.",
            agree={"kept": 1e-4},
        )
    ]
