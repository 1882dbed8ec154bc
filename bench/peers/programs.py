# SPDX-License-Identifier: GPL-3.0-or-later
"""The programs that rows can name, and their command lines."""
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent / "drivers"
COMPILED = ("scanmill", "cgal", "pcl", "meshoptimizer")
PYTHON = ("open3d", "pymeshlab", "trimesh", "meshio", "scipy", "vtk", "fast-simplification")


def command(program, build):
    """The command line; `build` is a build folder of the preset bench."""
    if program in COMPILED:
        return [str(pathlib.Path(build) / "bin" / f"peer_{program}")]
    if program in PYTHON:
        return [sys.executable, str(FOLDER / f"{program.replace('-', '_')}_driver.py")]
    raise KeyError(f"there is no program {program}; the programs are {', '.join(COMPILED + PYTHON)}")
