# SPDX-License-Identifier: GPL-3.0-or-later
"""From points to a mesh, compared with the tetrahedralisation alone: by alpha-solid and sculpt, and by tight-cocone."""
from dataclasses import dataclass

from harness.row import Contender, Row, in_threads


@dataclass(frozen=True)
class Method:
    """A way from points to a mesh that begins with delaunay."""

    prefix: str  #: the start of its rows' names
    job: str  #: the job's name in the driver
    title: str
    steps: str  #: in words
    bare: str  #: the end of the remark on CGAL, which only tetrahedralises
    facts: tuple  #: that must not depend on the number of threads
    filters: tuple


METHODS = [
    Method("mesh", "sculpt", "a sculpted mesh", "delaunay, alpha-solid with an automatic radius and sculpt",
           "the first of the three steps; the ratio compares all three with it",
           ("cells", "alpha", "triangles", "removed", "interior_points"), ("delaunay", "alpha-solid", "sculpt")),
    Method("tight-cocone", "tight-cocone", "the closed mesh of tight-cocone", "delaunay and tight-cocone",
           "the first of the two steps; the ratio compares both with it",
           ("cells", "triangles", "unused"), ("delaunay", "tight-cocone")),
]


def rows(inputs, large):
    return [one for method in METHODS for one in rows_of(method, inputs, large)]


def rows_of(method, inputs, large):
    found = [
        row(method, "bunny", "bunny", inputs.scan("bunny", "meshes/bunny00.off")),
        row(method, "torus", "bumpy torus", inputs.torus(350_000)),
        row(method, "dragon", "dragon", inputs.scan("dragon", "dragon/dragon_vrip.ply")),
    ]
    if large:
        # One round of Scanmill takes half a minute and more, and more than 3 gigabytes.
        torus = inputs.torus(3_500_000)
        more = {"warm_up": False, "rounds": 2, "grows_from": f"{method.prefix}-torus"}
        found.append(row(method, "large-torus", "large bumpy torus", torus, **more))
    return found


def row(method, name, shape, cloud, **more):
    load = cloud.load()
    return Row(
        name=f"{method.prefix}-{name}",
        title=f"From points to {method.title}, {shape}",
        inputs=[cloud],
        contenders=[
            *in_threads([1, 2], "scanmill", {"do": method.job}, prepare=load),
            Contender("cgal", {"do": "delaunay"}, "Delaunay_triangulation_3", prepare=load,
                      differs=f"stops after the tetrahedralisation, {method.bare}"),
        ],
        equal=f"the points in memory as doubles. Scanmill runs {method.steps} in one process and delivers a mesh; CGAL "
        "makes no surface.",
        agree={fact: 0 for fact in method.facts},
        filters=list(method.filters),
        peak_per="cells",
        **more,
    )
