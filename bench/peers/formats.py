# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading and writing files beside meshio, trimesh and VTK: formats.py BUILD [ROUNDS].

Equal: the file (in the page cache, on a file system in memory), what it holds, one thread. Not equal: Scanmill delivers
double coordinates and checks them, meshio and VTK keep the file's float; "seconds" is inside each program, around
the call that reads or writes, without starting it.
"""
import math
import pathlib
import sys
import tempfile

import numpy

import harness

POINTS = 3_500_000
ACROSS = 592  # a grid of as many by as many squares has about 700 k triangles


def write_points(path):
    """Points on a spiral, binary little-endian, float."""
    turn = numpy.arange(POINTS) * 1e-3
    rows = numpy.stack([numpy.cos(turn), numpy.sin(turn), turn], axis=1).astype("<f4")
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {POINTS}\n"
    header += "".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n"
    path.write_bytes(header.encode() + rows.tobytes())


def write_triangles(path):
    """A wavy sheet of triangles, row after row, as a mesher would deliver it."""
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


def main():
    build = pathlib.Path(sys.argv[1])
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 9
    driver = str(pathlib.Path(__file__).with_name("formats_driver.py"))
    contenders = [harness.Contender("scanmill", [str(build / "bin" / "formats_driver")])]
    contenders += [harness.Contender(name, [sys.executable, driver, name]) for name in ("meshio", "vtk", "trimesh")]
    names = [contender.name for contender in contenders]
    memory = pathlib.Path("/dev/shm")
    failed = False
    with tempfile.TemporaryDirectory(dir=memory if memory.is_dir() else None) as folder:
        folder = pathlib.Path(folder)
        for name, make, what in (
            ("points.ply", write_points, f"binary PLY, {POINTS} float points"),
            ("sheet.stl", write_triangles, f"binary STL, {2 * ACROSS * ACROSS} triangles"),
        ):
            path = folder / name
            make(path)
            size = f"{path.stat().st_size / 1e6:.0f} MB"
            reading = harness.Row(f"read {what}, {size}", names)
            harness.run_in_turn(reading, contenders, rounds, lambda one: one.ask(f"read {path}"))
            print(reading.text(names[0]))
            failed = failed or names[0] in reading.failures
            writing = harness.Row(f"write {what}, {size}", names)
            harness.run_in_turn(writing, contenders, rounds, lambda one: one.ask(f"write {folder / one.name}{path.suffix}"))
            print(writing.text(names[0]))
            failed = failed or names[0] in writing.failures
    for contender in contenders:
        contender.close()
    return 1 if failed else 0


sys.exit(main())
