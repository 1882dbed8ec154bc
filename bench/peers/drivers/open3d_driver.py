# SPDX-License-Identifier: GPL-3.0-or-later
"""Open3D: voxels, alpha shapes, distances, decimation."""
import open3d

from answer import answer, of_decimation, of_distances, read_points, read_triangles, timed

held = {}


def load(request):
    points, triangles = read_points(request["path"]), read_triangles(request["path"])
    held["cloud"] = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
    held["mesh"] = open3d.geometry.TriangleMesh(
        held["cloud"].points, open3d.utility.Vector3iVector(triangles.astype("int32"))
    )
    if "points" in request:
        held["queries"] = open3d.core.Tensor(read_points(request["points"]).astype("float32"))
    return {"points": len(points), "triangles": len(triangles)}


def voxel_thin(request):
    seconds, thinned = timed(lambda: held["cloud"].voxel_down_sample(request["bin_size"]))
    return {"seconds": seconds, "kept": len(thinned.points)}


def alpha_shape(request):
    make = open3d.geometry.TriangleMesh.create_from_point_cloud_alpha_shape
    seconds, mesh = timed(lambda: make(held["cloud"], request["alpha"]))
    return {"seconds": seconds, "regular_facets": len(mesh.triangles)}


def distances(request):
    """The first query builds the scene's tree, so a query of one point counts as building."""
    scene = open3d.t.geometry.RaycastingScene(nthreads=request["threads"])
    mesh = open3d.t.geometry.TriangleMesh.from_legacy(held["mesh"])
    threads = request["threads"]

    def build():
        scene.add_triangles(mesh)
        scene.compute_distance(held["queries"][:1], nthreads=threads)

    building, _ = timed(build)
    asking, found = timed(lambda: scene.compute_distance(held["queries"], nthreads=threads))
    return of_distances(building + asking, building, found.numpy())


def decimate(request):
    seconds, mesh = timed(lambda: held["mesh"].simplify_quadric_decimation(request["triangles"]))
    return of_decimation(request, seconds, mesh.vertices, mesh.triangles)


answer(
    {"load": load, "voxel-thin": voxel_thin, "alpha-shape": alpha_shape, "distances": distances, "decimate": decimate},
    {"Open3D": open3d.__version__},
)
