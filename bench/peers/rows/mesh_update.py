# SPDX-License-Identifier: GPL-3.0-or-later
"""Updating a closed mesh where a small part was scanned again, compared with making the mesh anew."""
from harness.row import Contender, Row, in_threads


def rows(inputs, large):
    found = [
        row("bunny", "bunny", inputs.scan("bunny", "meshes/bunny00.off")),
        row("torus", "bumpy torus", inputs.torus(350_000)),
    ]
    if large:
        torus = inputs.torus(3_500_000)
        found.append(row("large-torus", "large bumpy torus", torus, warm_up=False, rounds=2,
                         grows_from="mesh-update-torus"))
    return found


def row(name, shape, cloud, **more):
    prepare = {**cloud.load(), "do": "load-model"}
    anew = "delaunay and tight-cocone of the model's points, without the scan"
    whole = "splits long edges everywhere, not only near the scan, and makes a surface through all points"
    return Row(
        name=f"mesh-update-{name}",
        title=f"Updating a mesh with a local scan, {shape}",
        inputs=[cloud],
        contenders=[
            *in_threads([1, 2], "scanmill", {"do": "mesh-update", "rebuild": "local"}, label="rebuild: local",
                        prepare=prepare),
            *in_threads([1, 2], "scanmill", {"do": "mesh-update", "rebuild": "whole"}, label="rebuild: whole",
                        prepare=prepare, differs=whole),
            *in_threads([1, 2], "scanmill", {"do": "tight-cocone"}, label="anew", prepare=prepare, differs=anew),
        ],
        equal="the model and the scan in memory. The model is tight-cocone's mesh of the points; the scan consists of "
        "the centroids of the 5,000 triangles nearest to its highest vertex. The time includes the search "
        "tree of the model.",
        filters=["mesh-update", "delaunay", "tight-cocone"],
        agree={"added": 0, "discarded": 0, "replaced": 0, "triangles": 0},
        **more,
    )
