# SPDX-License-Identifier: GPL-3.0-or-later
"""fast-simplification: quadric decimation in single precision."""
import importlib.metadata

import fast_simplification

from answer import answer, read_points, read_triangles, timed

held = {}


def load(request):
    held["points"] = read_points(request["path"]).astype("float32")
    held["triangles"] = read_triangles(request["path"]).astype("int32")
    return {"points": len(held["points"]), "triangles": len(held["triangles"])}


def decimate(request):
    work = fast_simplification.simplify
    seconds, (_, triangles) = timed(
        lambda: work(held["points"], held["triangles"], target_count=request["triangles"])
    )
    return {"seconds": seconds, "triangles": len(triangles)}


answer(
    {"load": load, "decimate": decimate},
    {"fast-simplification": importlib.metadata.version("fast-simplification")},
)
