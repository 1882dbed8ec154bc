# SPDX-License-Identifier: GPL-3.0-or-later
"""PyMeshLab: distances by get_hausdorff_distance, decimation."""
import importlib.metadata

import pymeshlab

from answer import answer, of_decimation, read_points, read_triangles, timed

held = {}


def load(request):
    held["mesh"] = read_points(request["path"]), read_triangles(request["path"])
    held["set"] = pymeshlab.MeshSet(verbose=False)
    held["set"].add_mesh(pymeshlab.Mesh(vertex_matrix=held["mesh"][0], face_matrix=held["mesh"][1]))
    if "points" in request:
        held["set"].add_mesh(pymeshlab.Mesh(vertex_matrix=read_points(request["points"])))
    return {"points": len(held["mesh"][0]), "triangles": len(held["mesh"][1])}


def distances(request):
    """Distances from every vertex of the second mesh to the first, without a distance limit."""
    points = held["set"].mesh(1).vertex_number()
    ask = held["set"].get_hausdorff_distance
    far = pymeshlab.PercentageValue(100)
    seconds, found = timed(
        lambda: ask(sampledmesh=1, targetmesh=0, samplevert=True, sampleface=False, samplenum=points, maxdist=far)
    )
    if found["n_samples"] != points:
        raise RuntimeError(f"took {found['n_samples']} samples instead of all {points} points")
    return {"seconds": seconds, "mean": found["mean"], "rms": found["RMS"], "max": found["max"]}


def decimate(request):
    """Decimates a fresh copy, because the filter changes its mesh. The copy is not timed. The options that the rows use
    are always set: PyMeshLab takes those of the previous call as defaults."""
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(vertex_matrix=held["mesh"][0], face_matrix=held["mesh"][1]))
    work = meshes.meshing_decimation_quadric_edge_collapse
    seconds, _ = timed(lambda: work(targetfacenum=request["triangles"], planarquadric=request["planarquadric"]))
    mesh = meshes.current_mesh()
    return of_decimation(request, seconds, mesh.vertex_matrix(), mesh.face_matrix())


answer(
    {"load": load, "distances": distances, "decimate": decimate},
    {"PyMeshLab": importlib.metadata.version("pymeshlab")},
)
