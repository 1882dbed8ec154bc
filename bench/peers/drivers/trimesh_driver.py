# SPDX-License-Identifier: GPL-3.0-or-later
"""trimesh: reads and writes files, repair, distances."""
import logging
import os

import trimesh

from answer import answer, of_distances, of_repair, read_points, read_triangles, timed

held = {}
logging.disable(logging.CRITICAL)


def load(request):
    held["arrays"] = read_points(request["path"]), read_triangles(request["path"])
    if "points" in request:
        held["queries"] = read_points(request["points"])
    return {"points": len(held["arrays"][0]), "triangles": len(held["arrays"][1])}


def sizes(mesh):
    return {"points": len(mesh.vertices), "triangles": len(getattr(mesh, "faces", ()))}


def read(request):
    """Reads a file. For STL files, process=True merges equal corners."""
    path = request["path"]
    held["file"] = None

    def work():
        mesh = trimesh.load(path, process=path.endswith(".stl"))
        mesh.vertices  # trimesh creates the array at the first access
        return mesh

    seconds, held["file"] = timed(work)
    return {"seconds": seconds, **sizes(held["file"])}


def write(request):
    seconds, _ = timed(lambda: held["file"].export(request["path"]))
    return {"seconds": seconds, "bytes": os.path.getsize(request["path"])}


def distances(request):
    """Uses a new mesh every time, because a mesh keeps its search tree."""
    points, triangles = held["arrays"]
    mesh = trimesh.Trimesh(points, triangles, process=False)
    building, _ = timed(lambda: mesh.triangles_tree)
    asking, found = timed(lambda: trimesh.proximity.closest_point(mesh, held["queries"])[1])
    return of_distances(building + asking, building, found)


def repair(request):
    points, triangles = held["arrays"]
    mesh = trimesh.Trimesh(points, triangles, process=False)

    def work():
        mesh.merge_vertices()
        trimesh.repair.fix_winding(mesh)

    seconds, _ = timed(work)
    return of_repair(seconds, mesh.vertices, mesh.faces)


answer(
    {"load": load, "read": read, "write": write, "repair": repair, "distances": distances},
    {"trimesh": trimesh.__version__},
)
