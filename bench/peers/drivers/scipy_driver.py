# SPDX-License-Identifier: GPL-3.0-or-later
"""SciPy: Delaunay triangulation by qhull."""
import scipy
from scipy.spatial import Delaunay

from answer import answer, read_points, timed

held = {}


def load(request):
    held["points"] = read_points(request["path"])
    return {"points": len(held["points"])}


def delaunay(request):
    seconds, found = timed(lambda: Delaunay(held["points"]))
    return {"seconds": seconds, "cells": len(found.simplices), "vertices": len(found.points) - len(found.coplanar)}


answer({"load": load, "delaunay": delaunay}, {"SciPy": scipy.__version__})
