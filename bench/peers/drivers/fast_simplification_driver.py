# SPDX-License-Identifier: GPL-3.0-or-later
"""fast-simplification: quadric decimation in single precision."""
import importlib.metadata

import fast_simplification

from answer import answer, of_decimation, read_points, read_triangles, timed

held = {}


def load(request):
    held["points"] = read_points(request["path"]).astype("float32")
    held["triangles"] = read_triangles(request["path"]).astype("int32")
    return {"points": len(held["points"]), "triangles": len(held["triangles"])}


def decimate(request):
    work = fast_simplification.simplify
    seconds, (points, triangles) = timed(
        lambda: work(held["points"], held["triangles"], target_count=request["triangles"], agg=request["agg"])
    )
    return of_decimation(request, seconds, points, triangles)


answer(
    {"load": load, "decimate": decimate},
    {"fast-simplification": importlib.metadata.version("fast-simplification")},
)
