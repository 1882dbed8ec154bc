# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading and writing files in the page cache, on a file system in memory if there is one."""
import atexit
import math
import pathlib
import shutil
import tempfile

from harness.inputs import Input
from harness.row import Contender, Row

POINTS = 3_500_000
ACROSS = 592  # squares per side of the grid; gives about 700 k triangles
OTHERS = ("meshio", "vtk", "trimesh")


def rows(inputs, large):
    folder = scratch()
    points = Input("a spiral of floats", folder / "points.ply", once(write_points))
    sheet = Input("a wavy sheet, row after row", folder / "sheet.stl", once(write_triangles))
    return [
        *both("ply", f"binary PLY, {POINTS:,} float points", points),
        *both("stl", f"binary STL, {2 * ACROSS * ACROSS:,} triangles", sheet),
    ]


def scratch():
    """A folder that is removed when the run ends."""
    memory = pathlib.Path("/dev/shm")
    folder = tempfile.mkdtemp(prefix="scanmill-peers-", dir=memory if memory.is_dir() else None)
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return pathlib.Path(folder)


def both(name, what, file):
    """The row that reads a file, and the row that writes the data read from it."""
    read = {"do": "read", "path": str(file.path)}
    copy = {program: str(file.path.with_name(program + file.path.suffix)) for program in ("scanmill", *OTHERS)}
    return [
        Row(
            name=f"read-{name}",
            title=f"Reading {what}",
            inputs=[file],
            contenders=[Contender(program, read) for program in ("scanmill", *OTHERS)],
            equal="the file, its content, one thread. Scanmill delivers double coordinates and checks them; meshio and "
            "VTK keep the floats of the file; trimesh makes doubles. Equal corners of an STL file are merged.",
            agree={"points": 0, "triangles": 0},
        ),
        Row(
            name=f"write-{name}",
            title=f"Writing {what}",
            inputs=[file],
            contenders=[
                Contender(program, {"do": "write", "path": path}, prepare=read) for program, path in copy.items()
            ],
            equal="the data read from the same file, binary, floats. Scanmill's file appears whole or not at all.",
            # The comments in PLY headers differ by a few hundred bytes of 42 million.
            agree={"bytes": 1e-5},
        ),
    ]


def once(write):
    def make(path):
        if not path.exists():
            write(path)

    return make


def write_points(path):
    """Points on a spiral, binary little-endian, float."""
    import numpy

    turn = numpy.arange(POINTS) * 1e-3
    rows = numpy.stack([numpy.cos(turn), numpy.sin(turn), turn], axis=1).astype("<f4")
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {POINTS}\n"
    header += "".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n"
    path.write_bytes(header.encode() + rows.tobytes())


def write_triangles(path):
    """A wavy sheet of triangles, row after row, as a mesh generator writes it."""
    import numpy

    step = numpy.arange(ACROSS + 1)
    x, y = numpy.meshgrid(step, step, indexing="ij")
    z = 10 * numpy.sin(x * math.pi / 100) * numpy.cos(y * math.pi / 130)
    corners = numpy.stack([x, y, z], axis=2).astype("<f4")
    a, b, c, d = corners[:-1, :-1], corners[1:, :-1], corners[1:, 1:], corners[:-1, 1:]
    triangles = numpy.stack([numpy.stack([a, b, c], axis=2), numpy.stack([a, c, d], axis=2)], axis=2).reshape(-1, 3, 3)
    facets = numpy.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    facets["corners"] = triangles
    normals = numpy.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    facets["normal"] = normals / numpy.linalg.norm(normals, axis=1)[:, None]
    path.write_bytes(b"a wavy sheet".ljust(80) + numpy.uint32(len(facets)).tobytes() + facets.tobytes())
