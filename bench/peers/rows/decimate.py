# SPDX-License-Identifier: GPL-3.0-or-later
"""Decimation to a tenth of the triangles. quality/decimate.py compares the results at equal distance."""
from harness.row import Contender, Row, in_threads

UNBOUNDED = "the error of the results; the other programs take no bound of the distance between the surfaces"
#: Percent of the diagonal; large enough for a tenth of the triangles.
MAX_ERROR = {"bunny": 0.1, "armadillo": 0.5, "dragon": 0.1}

#: fast-simplification's "aggression", 7 by default. At equal distance, 4 needs the fewest triangles: on the bunny at
#: 1 % of the diagonal 588, with the default 1,592, and with 3 it stops at 1,884.
AGG = 4


def rows(inputs, large):
    found = [
        row("decimate-bunny", "bunny", inputs.scan("bunny", "meshes/bunny00.off"), 7_540),
        row("decimate-armadillo", "armadillo", inputs.scan("armadillo", "meshes/armadillo.off"), 5_200),
    ]
    if large:
        dragon = inputs.scan("dragon", "dragon/dragon_vrip.ply")
        found.append(row("decimate-dragon", "dragon", dragon, 87_141, grows_from="decimate-bunny"))
    return found


def others(mesh, **more):
    """The other programs that decimate to a number of triangles. `more` is part of the requests.

    PyMeshLab's planarquadric is off by default. On the bunny, the default is nearer to the input; on models with
    planes, planarquadric is. vtkDecimatePro is left out: at 10 % of the bunny's triangles its distance is 0.74 % of the
    diagonal, that of vtkQuadricDecimation 0.13 %.
    """
    load, work = mesh.load(), {"do": "decimate", **more}
    return [
        Contender("meshoptimizer", work, prepare=load),
        Contender("cgal", work, "Garland–Heckbert", prepare=load),
        Contender("fast-simplification", {**work, "agg": AGG}, f"agg={AGG}", prepare=load),
        Contender("vtk", work, "vtkQuadricDecimation", prepare=load),
        Contender("pymeshlab", {**work, "planarquadric": False}, prepare=load),
        Contender("pymeshlab", {**work, "planarquadric": True}, "planarquadric", prepare=load),
        Contender("open3d", work, prepare=load),
    ]


def row(name, shape, mesh, triangles, **more):
    ours = {"do": "decimate", "triangles": triangles, "max_error": MAX_ERROR[shape]}
    return Row(
        name=name,
        title=f"Decimation to {triangles:,} triangles, {shape}",
        inputs=[mesh],
        contenders=[*in_threads([1, 2], "scanmill", ours, prepare=mesh.load()), *others(mesh, triangles=triangles)],
        equal=f"the mesh in memory and the target number of triangles. Scanmill also keeps to {MAX_ERROR[shape]} % of the "
        f"diagonal. Not compared: {UNBOUNDED}. Scanmill's seconds contain the certificate.",
        agree={"triangles": 0.01},
        filters=["decimate"],
        rounds=3,
        peak_per="input_triangles",
        **more,
    )
