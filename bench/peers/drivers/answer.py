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
