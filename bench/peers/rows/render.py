# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of a mesh, without a display."""
from harness.row import Contender, Row, in_threads

WORK = {"do": "render", "width": 800, "height": 600}


def rows(inputs, large):
    scans = [("render-bunny", "the bunny", inputs.scan("bunny", "meshes/bunny00.off")),
             ("render-dragon", "the dragon", inputs.scan("dragon", "dragon/dragon_vrip.ply"))]
    return [row(*scan) for scan in scans]


def row(name, what, mesh):
    return Row(
        name=name,
        title=f"A picture of {what}, 800 x 600, from above",
        inputs=[mesh],
        contenders=[
            *in_threads([1, 2], "scanmill", WORK, prepare=mesh.load()),
            Contender("vtk", WORK, "software OpenGL", prepare=mesh.load()),
            *in_threads([1, 2], "open3d", WORK, label="RaycastingScene", prepare=mesh.load()),
        ],
        equal="the mesh in memory; the pixels are in memory afterwards. The time includes search structures, buffers and "
        "normals. Scanmill casts 4 rays per pixel and 8 more for ambient occlusion, in doubles. VTK draws one sample per "
        "pixel with smooth normals and without occlusion. Open3D casts one ray per pixel, in floats, and the facets' "
        "normals are its shading.",
        agree={"covered": 2e-2},
        filters=["render"],
    )
