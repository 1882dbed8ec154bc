# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by the Python drivers: reads requests as JSON lines, writes answers, and reads and writes raw arrays. See
answer.hpp."""
import json
import os
import pathlib
import sys
import time

import numpy


def answer(jobs, versions):
    """Answers requests until standard input ends: {"do": JOB, …} calls jobs[JOB](request). Output of the libraries goes
    to standard error."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    jobs = {**jobs, "versions": lambda request: versions}
    for line in sys.stdin:
        request = json.loads(line)
        try:
            if request["do"] not in jobs:
                raise ValueError(f"this program cannot do '{request['do']}'")
            result = jobs[request["do"]](request)
        except BaseException as error:  # SystemExit too, which meshio raises; a failure of a program is an answer
            result = {"failed": f"{type(error).__name__}: {' '.join(str(error).split())}"}
        print(json.dumps(result), file=answers, flush=True)


def timed(work):
    """The seconds that work() took, and its result."""
    begin = time.perf_counter()
    result = work()
    return time.perf_counter() - begin, result


def read_points(path):
    """#points by 3 doubles."""
    return numpy.fromfile(path + ".points").reshape(-1, 3)


def read_normals(path):
    """#points by 3 doubles; None without normals."""
    path = pathlib.Path(path + ".normals")
    return numpy.fromfile(path).reshape(-1, 3) if path.exists() else None


def read_triangles(path):
    """#triangles by 3 indices; empty for a cloud."""
    path = pathlib.Path(path + ".triangles")
    indices = numpy.fromfile(path, dtype=numpy.uint32) if path.exists() else numpy.zeros(0, numpy.uint32)
    return indices.reshape(-1, 3)


def of_decimation(request, seconds, points, triangles):
    """The answer to "decimate"; with "into" in the request, writes the mesh into raw arrays."""
    if "into" in request:
        numpy.ascontiguousarray(points, numpy.float64).tofile(request["into"] + ".points")
        numpy.ascontiguousarray(triangles, numpy.uint32).tofile(request["into"] + ".triangles")
    return {"seconds": seconds, "triangles": len(triangles)}


def enclosed_volume(points, triangles):
    """The volume that the triangles enclose if they are closed; negative if they face inwards."""
    a, b, c = (numpy.asarray(points, numpy.float64)[numpy.asarray(triangles)[:, corner]] for corner in range(3))
    return float(numpy.einsum("ij,ij->i", a, numpy.cross(b, c)).sum() / 6)


def boundary_edges(triangles):
    """Number of edges in exactly one triangle."""
    triangles = numpy.asarray(triangles)
    edges = numpy.sort(numpy.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    return int((numpy.unique(edges, axis=0, return_counts=True)[1] == 1).sum())


def of_reconstruction(seconds, points, triangles):
    """The answer to "poisson"."""
    return {"seconds": seconds, "triangles": len(triangles), "volume": enclosed_volume(points, triangles)}


def of_filling(seconds, points, triangles):
    """The answer to "fill-holes"."""
    return {"seconds": seconds, "boundary_edges": boundary_edges(triangles), "triangles": len(triangles),
            "volume": enclosed_volume(points, triangles)}


def of_repair(seconds, points, triangles):
    """The answer to "repair"."""
    return {"seconds": seconds, "points": len(points), "boundary_edges": boundary_edges(triangles),
            "enclosed": abs(enclosed_volume(points, triangles))}


def directions(request, points, normals):
    """The answer about normals; see answer.hpp."""
    size = numpy.abs(normals)
    answer = {"along_x": float(((size[:, 0] > size[:, 1]) & (size[:, 0] > size[:, 2])).mean())}
    if request.get("oriented"):
        answer["flux"] = float((numpy.asarray(points) * normals).sum(axis=1).mean())
    return answer


def of_distances(seconds, building, distances):
    """The answer to "distances", from one distance per point."""
    distances = numpy.asarray(distances, dtype=numpy.float64)
    return {
        "seconds": seconds,
        "building_seconds": building,
        "mean": float(distances.mean()),
        "rms": float(numpy.sqrt((distances**2).mean())),
        "max": float(distances.max()),
    }
