#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""measure.py PROGRAM: compares `scanmill measure` with trimesh and Open3D on the same files, and checks `hausdorff`.

Distances are from all points of a scan to the nearest point of a mesh's triangles; all three programs define them in the
same way, as well as area, volume and Euler number. trimesh gets all coordinates ten thousand times as large and its results
are scaled back, because it treats triangles below an absolute size as degenerate. Open3D computes in float.

`hausdorff` is compared with the certified lower bound of the same two meshes: the pairs above, and CGAL's elephant and hand
against their decimation to a quarter of the triangles (Open3D's quadric decimation).

Differences are shares of the mesh's diagonal (areas and volumes: of its square and cube). Exits with 1 if one is above 1e-6,
if an Euler number differs, or if a `hausdorff` is more than 2 % below the certified bound.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy
import open3d
import trimesh

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from tables.ply import write_ply  # noqa: E402

DATA = pathlib.Path("build/data")
PAIRS = [("meshes/bunny00.off", "meshes/bunny00.off", 0.01), ("dragon/dragon_vrip.ply", "dragon/dragon_vrip_res3.ply", 0),
         ("meshes/elephant.off", "meshes/elephant-with-holes.off", 0.02), ("meshes/fandisk_large.off", "meshes/fandisk_large.off", 0.1),
         ("meshes/anchor_dense.off", "meshes/anchor.off", 0.02)]
DECIMATED = ["meshes/elephant.off", "meshes/hand.off"]
LARGEST = 1e-6
LARGEST_SHORTFALL = 0.02
SCALE = 1e4


def load(name):
    return trimesh.load(DATA / name, process=False)


def metrics(program, mesh, truth, *options):
    printed = subprocess.run([program, "measure", mesh, truth, "--json", "--set", "self-intersections=false", *options],
                             capture_output=True, text=True, check=True)
    return json.loads(printed.stdout)["metrics"]


def ours(program, mesh, points, folder):
    """The mesh is written as a PLY of doubles, so that all three programs measure the same numbers."""
    truth = folder / "points.ply"
    surface = folder / "mesh.ply"
    write_ply(surface, mesh.vertices, mesh.faces)
    write_ply(truth, points)
    return metrics(program, surface, truth)


def decimated(name, folder):
    mesh = load(name)
    shape = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(mesh.vertices),
                                         open3d.utility.Vector3iVector(mesh.faces))
    shape = shape.simplify_quadric_decimation(len(mesh.faces) // 4)
    path = folder / "decimated.ply"
    write_ply(path, numpy.asarray(shape.vertices), numpy.asarray(shape.triangles))
    return path


def shortfall(program, mesh, truth):
    """The share by which `hausdorff` is below the certified lower bound."""
    found = metrics(program, mesh, truth)["hausdorff"]
    lower = metrics(program, mesh, truth, "--certify")["hausdorff-lower"]
    share = max(0, 1 - found / lower) if lower > 0 else 0
    print(f"{pathlib.Path(mesh).name} against {pathlib.Path(truth).name}: hausdorff {found:.6g}, certified at least {lower:.6g}: "
          f"{100 * share:.2g} % below")
    return share


def largest_shortfall(program):
    shares = [shortfall(program, DATA / name, DATA / other) for name, other, _ in PAIRS if name != other]
    for name in DECIMATED:
        with tempfile.TemporaryDirectory() as folder:
            shares.append(shortfall(program, decimated(name, pathlib.Path(folder)), DATA / name))
    return max(shares)


def numbers(distances):
    return {"mean": distances.mean(), "rms": numpy.sqrt((distances**2).mean()), "max": distances.max()}


def of_trimesh(mesh, points):
    large = trimesh.Trimesh(mesh.vertices * SCALE, mesh.faces, process=False)
    distances = numpy.concatenate([trimesh.proximity.closest_point(large, part)[1]
                                   for part in numpy.array_split(points * SCALE, max(1, len(points) // 5000))])
    found = numbers(distances / SCALE)
    found["area"] = large.area / SCALE**2
    found["euler"] = large.euler_number
    if large.is_watertight:
        found["volume"] = large.volume / SCALE**3
    return found


def of_open3d(mesh, points):
    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(open3d.core.Tensor(numpy.asarray(mesh.vertices, numpy.float32)),
                        open3d.core.Tensor(numpy.asarray(mesh.faces, numpy.uint32)))
    distances = scene.compute_distance(open3d.core.Tensor(numpy.asarray(points, numpy.float32))).numpy()
    return numbers(distances.astype(float))


def main(program):
    worst = 0
    for name, other, push in PAIRS:
        mesh, points = load(name), numpy.asarray(load(other).vertices)
        diagonal = numpy.linalg.norm(mesh.extents)
        if push:  # the mesh's own points, moved off the surface
            points = points + push * diagonal * numpy.random.default_rng(1).normal(size=points.shape)
        with tempfile.TemporaryDirectory() as folder:
            measured = ours(program, mesh, points, pathlib.Path(folder))
        print(f"{name}, {len(mesh.faces):,} triangles; {len(points):,} points of {other}: "
              f"mean {measured['mean']:.9g}, max {measured['max']:.9g}")
        for program_name, found in {"trimesh": of_trimesh(mesh, points), "Open3D": of_open3d(mesh, points)}.items():
            differences = {}
            for key, value in found.items():
                if key == "euler":
                    differences[key] = 0 if value == measured[key] else numpy.inf
                else:
                    power = {"area": 2, "volume": 3}.get(key, 1)
                    differences[key] = abs(value - measured[key]) / diagonal**power
            if not all(numpy.isfinite(difference) for difference in differences.values()):
                worst = numpy.inf
            worst = max(worst, *differences.values())
            print(f"  {program_name:<8}" + "".join(f" {key} {value:.1e}" for key, value in differences.items()))
    print(f"largest difference: {worst:.1e} of the diagonal")
    below = largest_shortfall(program)
    return 0 if worst <= LARGEST and below <= LARGEST_SHORTFALL else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
