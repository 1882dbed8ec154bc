# SPDX-License-Identifier: GPL-3.0-or-later
"""meshio: reads and writes files. It merges the equal corners of an STL file, as Scanmill does. Arrays have the type of
the file."""
import os

import meshio

from answer import answer, timed

held = {}


def sizes(mesh):
    return {
        "points": len(mesh.points),
        "triangles": sum(len(cells.data) for cells in mesh.cells if cells.type == "triangle"),
    }


def read(request):
    held["file"] = None
    seconds, held["file"] = timed(lambda: meshio.read(request["path"]))
    return {"seconds": seconds, **sizes(held["file"])}


def write(request):
    seconds, _ = timed(lambda: meshio.write(request["path"], held["file"], binary=True))
    return {"seconds": seconds, "bytes": os.path.getsize(request["path"])}


answer({"read": read, "write": write}, {"meshio": meshio.__version__})
