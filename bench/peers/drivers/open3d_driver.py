# SPDX-License-Identifier: GPL-3.0-or-later
"""Open3D: voxels, normals, alpha shapes, Poisson reconstruction, distances, decimation, registration."""
import math

import numpy
import open3d

from answer import answer, directions, of_decimation, of_distances, of_reconstruction
from answer import read_normals, read_points, read_triangles, timed

held = {}


def mesh_of(points, triangles):
    return open3d.geometry.TriangleMesh(points, open3d.utility.Vector3iVector(triangles.astype("int32")))


def load(request):
    points, triangles = read_points(request["path"]), read_triangles(request["path"])
    held["cloud"] = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
    held["mesh"] = mesh_of(held["cloud"].points, triangles)
    normals = read_normals(request["path"])
    if normals is not None:
        held["cloud"].normals = open3d.utility.Vector3dVector(normals)
    if "points" in request:
        held["queries"] = open3d.core.Tensor(read_points(request["points"]).astype("float32"))
        held["truth"] = mesh_of(open3d.utility.Vector3dVector(read_points(request["points"])),
                                read_triangles(request["points"]))
    return {"points": len(points), "triangles": len(triangles)}


def voxel_thin(request):
    seconds, thinned = timed(lambda: held["cloud"].voxel_down_sample(request["bin_size"]))
    return {"seconds": seconds, "kept": len(thinned.points)}


def normals(request):
    """The normals of planes through the nearest points, the point itself included."""
    cloud, neighbours = open3d.geometry.PointCloud(held["cloud"].points), request["neighbours"]

    def work():
        cloud.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(neighbours + 1))
        if request.get("oriented"):
            cloud.orient_normals_consistent_tangent_plane(neighbours + 1)

    seconds, _ = timed(work)
    return {"seconds": seconds, **directions(request, cloud.points, numpy.asarray(cloud.normals))}


def poisson(request):
    make = open3d.geometry.TriangleMesh.create_from_point_cloud_poisson
    depth, scale = request["depth"], request["scale"]
    seconds, (mesh, _) = timed(lambda: make(held["cloud"], depth=depth, scale=scale, n_threads=1))
    return of_reconstruction(seconds, mesh.vertices, mesh.triangles)


def measure(request):
    """Distances of uniform samples in both directions."""
    means = []

    def one_way(samples_of, mesh):
        scene = open3d.t.geometry.RaycastingScene(nthreads=request["threads"])
        scene.add_triangles(open3d.t.geometry.TriangleMesh.from_legacy(mesh))
        points = numpy.asarray(samples_of.sample_points_uniformly(request["samples"]).points).astype("float32")
        found = scene.compute_distance(open3d.core.Tensor(points), nthreads=request["threads"])
        means.append(float(found.numpy().astype("float64").mean()))

    def work():
        one_way(held["mesh"], held["truth"])
        one_way(held["truth"], held["mesh"])
        return held["mesh"].get_surface_area()

    seconds, area = timed(work)
    return {"seconds": seconds, "mean": sum(means) / 2, "area": area}


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


def inspect(request):
    """Signed distances and their statistics, without a map on the nominal."""

    def work():
        scene = open3d.t.geometry.RaycastingScene(nthreads=request["threads"])
        scene.add_triangles(open3d.t.geometry.TriangleMesh.from_legacy(held["mesh"]))
        found = scene.compute_signed_distance(held["queries"], nthreads=request["threads"]).numpy().astype("float64")
        is_in_tolerance = numpy.abs(found) <= request["tolerance"]
        return numpy.sqrt((found**2).mean()), found.min(), found.max(), is_in_tolerance.mean()

    seconds, (rms, least, largest, share) = timed(work)
    return {"seconds": seconds, "rms": float(rms), "min": float(least), "max": float(largest),
            "in_tolerance": float(share)}


def decimate(request):
    seconds, mesh = timed(lambda: held["mesh"].simplify_quadric_decimation(request["triangles"]))
    return of_decimation(request, seconds, mesh.vertices, mesh.triangles)


def render(request):
    """A parallel view from above: one ray per pixel, and the facets' normals. The margins are Scanmill's."""
    width, height = request["width"], request["height"]
    low, high = held["mesh"].get_min_bound(), held["mesh"].get_max_bound()
    size = high - low

    def work():
        scene = open3d.t.geometry.RaycastingScene(nthreads=request["threads"])
        scene.add_triangles(open3d.t.geometry.TriangleMesh.from_legacy(held["mesh"]))
        pixel = max(size[0] / width, size[1] / height) / 0.9
        columns = (low[0] + high[0]) / 2 + (numpy.arange(width) + 0.5 - width / 2) * pixel
        lines = (low[1] + high[1]) / 2 - (numpy.arange(height) + 0.5 - height / 2) * pixel
        rays = numpy.zeros((height, width, 6), dtype="float32")
        rays[..., 0], rays[..., 1], rays[..., 2], rays[..., 5] = columns, lines[:, None], high[2] + size[2], -1
        hits = scene.cast_rays(open3d.core.Tensor(rays), nthreads=request["threads"])
        return hits["primitive_normals"].numpy(), hits["t_hit"].numpy()

    seconds, (_, distances) = timed(work)
    return {"seconds": seconds, "covered": float(numpy.isfinite(distances).mean())}


def icp(request):
    """The motion from the second input to the points of the first, point to plane, from where they are."""
    registration = open3d.pipelines.registration
    source = open3d.geometry.PointCloud(held["truth"].vertices)
    box = source.get_axis_aligned_bounding_box()
    limit = request["max_distance"] / 100 * float(numpy.linalg.norm(box.get_extent()))
    end = registration.ICPConvergenceCriteria(relative_fitness=1e-9, relative_rmse=1e-9, max_iteration=50)
    seconds, found = timed(lambda: registration.registration_icp(
        source, held["cloud"], limit, numpy.eye(4), registration.TransformationEstimationPointToPlane(), end))
    motion, centre = found.transformation, box.get_center()
    return {
        "seconds": seconds,
        "angle": math.degrees(math.acos((numpy.trace(motion[:3, :3]) - 1) / 2)),
        "shift": float(numpy.linalg.norm(motion[:3, :3] @ centre + motion[:3, 3] - centre)),
        "residual": found.inlier_rmse,
    }


answer(
    {"load": load, "voxel-thin": voxel_thin, "normals": normals, "alpha-shape": alpha_shape, "poisson": poisson,
     "measure": measure, "distances": distances, "decimate": decimate, "icp": icp,
     "inspect": inspect, "render": render},
    {"Open3D": open3d.__version__},
)
