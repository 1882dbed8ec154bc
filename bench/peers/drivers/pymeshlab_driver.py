# SPDX-License-Identifier: GPL-3.0-or-later
"""PyMeshLab: reconstruction, repair, measuring, subdivision, decimation."""
import importlib.metadata

import pymeshlab

from answer import answer, of_decimation, of_filling, of_reconstruction, of_repair
from answer import read_normals, read_points, read_triangles, timed

held = {}


def fresh():
    """A set with a copy of the loaded mesh: filters change their mesh. The copy is not timed."""
    meshes = pymeshlab.MeshSet(verbose=False)
    points, triangles = held["mesh"]
    more = {"v_normals_matrix": held["normals"]} if held["normals"] is not None else {}
    meshes.add_mesh(pymeshlab.Mesh(vertex_matrix=points, face_matrix=triangles, **more))
    return meshes


def arrays(meshes):
    mesh = meshes.current_mesh()
    return mesh.vertex_matrix(), mesh.face_matrix()


def load(request):
    held["mesh"] = read_points(request["path"]), read_triangles(request["path"])
    held["normals"] = read_normals(request["path"])
    held["set"] = fresh()
    if "points" in request:
        points, triangles = read_points(request["points"]), read_triangles(request["points"])
        held["set"].add_mesh(pymeshlab.Mesh(vertex_matrix=points, face_matrix=triangles))
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
    """The options that the rows use are always set: PyMeshLab takes those of the previous call as defaults."""
    meshes = fresh()
    work = meshes.meshing_decimation_quadric_edge_collapse
    seconds, _ = timed(lambda: work(targetfacenum=request["triangles"], planarquadric=request["planarquadric"]))
    return of_decimation(request, seconds, *arrays(meshes))


def poisson(request):
    meshes = fresh()
    work = meshes.generate_surface_reconstruction_screened_poisson
    seconds, _ = timed(lambda: work(depth=request["depth"], scale=request["scale"], threads=1))
    return of_reconstruction(seconds, *arrays(meshes))


def fill_holes(request):
    """Closes holes of any number of edges."""
    meshes = fresh()
    seconds, _ = timed(lambda: meshes.meshing_close_holes(maxholesize=1_000_000, selfintersection=False))
    return of_filling(seconds, *arrays(meshes))


def repair(request):
    meshes = fresh()

    def work():
        meshes.meshing_remove_duplicate_vertices()
        meshes.meshing_re_orient_faces_coherently()

    seconds, _ = timed(work)
    return of_repair(seconds, *arrays(meshes))


def measure(request):
    """Distances of samples in both directions, and the numbers of both meshes."""
    meshes, far = held["set"], pymeshlab.PercentageValue(100)
    where = {"samplevert": False, "sampleedge": False, "sampleface": True, "maxdist": far}

    def work():
        found = [meshes.get_hausdorff_distance(sampledmesh=one, targetmesh=1 - one, samplenum=request["samples"], **where)
                 for one in (0, 1)]
        geometry = []
        for one in (0, 1):
            meshes.set_current_mesh(one)
            geometry.append(meshes.get_geometric_measures())
            meshes.get_topological_measures()
        return sum(one["mean"] for one in found) / 2, geometry[0]["surface_area"]

    seconds, (mean, area) = timed(work)
    return {"seconds": seconds, "mean": mean, "area": area}


def subdivide(request):
    """Butterfly: the vertices of the mesh stay."""
    meshes, count = fresh(), request["segments"].bit_length() - 1
    work = meshes.meshing_surface_subdivision_butterfly
    seconds, _ = timed(lambda: work(iterations=count, threshold=pymeshlab.PureValue(0)))
    return {"seconds": seconds, "triangles": meshes.current_mesh().face_number()}


answer(
    {"load": load, "poisson": poisson, "fill-holes": fill_holes, "repair": repair, "measure": measure,
     "distances": distances, "subdivide": subdivide, "decimate": decimate},
    {"PyMeshLab": importlib.metadata.version("pymeshlab")},
)
