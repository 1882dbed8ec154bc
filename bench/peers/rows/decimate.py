# SPDX-License-Identifier: GPL-3.0-or-later
"""Decimation to a tenth of the triangles. Scanmill has no such filter yet."""
from harness.row import Contender, Row

UNBOUNDED = "the error of the results; none of the programs takes an error bound"


def rows(inputs, large):
    coarser = inputs.scan("dragon-res2", "dragon/dragon_vrip_res2.ply")
    found = [
        row("decimate-bunny", "bunny", inputs.scan("bunny", "meshes/bunny00.off"), 7_540),
        row("decimate-coarser-dragon", "coarser dragon", coarser, 20_252),
    ]
    if large:
        dragon = inputs.scan("dragon", "dragon/dragon_vrip.ply")
        found.append(row("decimate-dragon", "dragon", dragon, 87_141))
    return found


def row(name, shape, mesh, triangles):
    load, work = mesh.load(), {"do": "decimate", "triangles": triangles}
    return Row(
        name=name,
        title=f"Decimation to {triangles:,} triangles, {shape}",
        inputs=[mesh],
        contenders=[
            Contender("meshoptimizer", work, prepare=load),
            Contender("fast-simplification", work, prepare=load),
            Contender("vtk", work, "vtkQuadricDecimation", prepare=load),
            Contender("pymeshlab", work, prepare=load),
            Contender("open3d", work, prepare=load),
        ],
        equal=f"the mesh in memory and the target number of triangles. Not compared: {UNBOUNDED}. Scanmill has no "
        "decimation yet.",
        agree={"triangles": 0.01},
        rounds=3,
    )
