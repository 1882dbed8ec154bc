#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""measure.py PROGRAM: compares `scanmill measure` with trimesh and Open3D on the same files.

Compares the distances from all points of a scan to the nearest point of a mesh's triangles, the area, the volume and
the Euler characteristic. They have the same meaning in all three programs. trimesh treats triangles below an absolute
size as degenerate, so its input is scaled up by 10,000 and its results are scaled back. Open3D computes in float.

Differences are shares of the mesh's diagonal (of its square for areas and its cube for volumes). The exit code is 1 if
one is above 1e-6 or the Euler characteristics differ.
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
LARGEST = 1e-6
SCALE = 1e4


def load(name):
    return trimesh.load(DATA / name, process=False)


def ours(program, mesh, points, folder):
    """Runs `scanmill measure` on PLY files of doubles, so that all programs use the same coordinates."""
    truth = folder / "points.ply"
    surface = folder / "mesh.ply"
    write_ply(surface, mesh.vertices, mesh.faces)
    write_ply(truth, points)
    done = subprocess.run([program, "measure", surface, truth, "--json", "--set", "self-intersections=false"],
                          capture_output=True, text=True, check=True)
    return json.loads(done.stdout)["metrics"]


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
        if push:  # move the points off the surface
            points = points + push * diagonal * numpy.random.default_rng(1).normal(size=points.shape)
        with tempfile.TemporaryDirectory() as folder:
            metrics = ours(program, mesh, points, pathlib.Path(folder))
        print(f"{name}, {len(mesh.faces):,} triangles; {len(points):,} points of {other}: "
              f"mean {metrics['mean']:.9g}, max {metrics['max']:.9g}")
        for program_name, found in {"trimesh": of_trimesh(mesh, points), "Open3D": of_open3d(mesh, points)}.items():
            differences = {}
            for key, value in found.items():
                if key == "euler":
                    differences[key] = 0 if value == metrics[key] else numpy.inf
                else:
                    power = {"area": 2, "volume": 3}.get(key, 1)
                    differences[key] = abs(value - metrics[key]) / diagonal**power
            if not all(numpy.isfinite(difference) for difference in differences.values()):
                worst = numpy.inf
            worst = max(worst, *differences.values())
            print(f"  {program_name:<8}" + "".join(f" {key} {value:.1e}" for key, value in differences.items()))
    print(f"largest difference: {worst:.1e} of the diagonal")
    return 0 if worst <= LARGEST else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
