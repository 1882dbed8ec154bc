# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlier removal by the mean distances to the nearest points."""
from harness.row import Contender, Row, in_threads

WORK = {"do": "remove-outliers", "neighbours": 16, "factor": 3}
#: About the share that the mean plus three standard deviations excludes here.
PERCENT = 0.3
KEEPS_LESS = "removes all suspects; Scanmill keeps those that are connected to the scan"


def rows(inputs, large):
    cloud = inputs.random_torus(1_000_000)
    return [
        row("outlier-removal-test", "the test alone (min-component: 0)", cloud, 0, ""),
        row("outlier-removal", "with connected components", cloud, 0.1, KEEPS_LESS),
    ]


def row(name, what, cloud, min_component, differs):
    load = cloud.load()
    return Row(
        name=name,
        title=f"Outlier removal from 1,000,000 points, 16 neighbours, {what}",
        inputs=[cloud],
        contenders=[
            *in_threads([1, 2], "scanmill", {**WORK, "min_component": min_component}, prepare=load),
            Contender("pcl", WORK, "StatisticalOutlierRemoval", prepare=load, differs=differs),
            *in_threads(
                [1, 2], "cgal", {**WORK, "percent": PERCENT}, label="remove_outliers", prepare=load,
                differs="removes a given percentage of the points, those with the largest mean squared distances",
            ),
        ],
        equal="the points in memory, the number of neighbours and the factor. The time includes the tree and the copy "
        "of the kept points. Scanmill stores doubles and PCL floats, so points at the limit may differ.",
        agree={"kept": 1e-4},
        filters=["outlier-removal"],
    )
