#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""raw_views.py PROGRAM FOLDER: compares the workflow raw-scans with Open3D's Poisson reconstruction and ball pivoting on raw views.

FOLDER has the Stanford bunny's ten views and bun.conf in 1-bunny/raw, its merged mesh in 1-bunny/bun_zipper.ply, and the Happy
Buddha's fifteen standing views and their poses in 5-raw/happy_stand. The truth of the bunny is the merged mesh's points; of the Buddha,
three views (24, 144 and 264 degrees) that no program gets. Open3D gets the merged points without outliers, with the normals of our
filter `normals`; ball pivoting gets them thinned to two spacings, with radii of 3, 6 and 12 spacings.

Distances are from the points of the truth to the mesh, by `scanmill measure` with `borders: exclude`; recall is the share nearer than
0.5 % of the mesh's diagonal.
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy
import open3d

WORKFLOW = pathlib.Path(__file__).resolve().parents[2] / "workflows/raw-scans.yaml"
HELD_OUT = ["_24", "_144", "_264"]
DEPTH = 8
MERGED = """scanmill: 1
name: merged
inputs: {views: {kind: points, list: true, frame: "{stem}"}}
parameters: {poses: {default: none}}
steps:
  - merge: {poses: $poses}
  - outlier-removal:
  - normals: {neighbours: 40}
outputs: {"merged.ply": normals}
"""


def run(program, workflow, views, poses, folder):
    """The seconds that it took. A doubtful result is one."""
    start = time.time()
    subprocess.run([program, "run", workflow, *views, "--set", f"poses={poses}", "-o", folder, "--quiet"],
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
    return time.time() - start


def row(program, scan, name, mesh, truth, seconds):
    printed = subprocess.run([program, "measure", mesh, truth, "--json", "--set", "borders=exclude"],
                             capture_output=True, text=True, check=True)
    found = json.loads(printed.stdout)["metrics"]
    numbers = {key: found[key]["value"] if isinstance(found[key], dict) else found[key]
               for key in ("mean-from-truth", "recall", "diagonal", "closed", "components", "boundary-loops",
                           "self-intersections")}
    print(f"| {scan} | {name} | {100 * numbers['mean-from-truth'] / numbers['diagonal']:.4f} | {numbers['recall']:.4f} | "
          f"{'yes' if numbers['closed'] else 'no'} | {numbers['components']:.0f} | {numbers['boundary-loops']:.0f} | "
          f"{numbers['self-intersections']:.0f} | {seconds:.0f} |", flush=True)


def compare(program, scan, views, poses, truth, folder):
    seconds = run(program, WORKFLOW, views, poses, folder)
    row(program, scan, "raw-scans", folder / "raw-scans.ply", truth, seconds)
    cloud = open3d.io.read_point_cloud(str(folder / "merged.ply"))
    start = time.time()
    mesh, _ = open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=DEPTH)
    seconds = time.time() - start
    open3d.io.write_triangle_mesh(str(folder / "other.ply"), mesh, write_vertex_normals=False)
    row(program, scan, f"Poisson, depth {DEPTH}", folder / "other.ply", truth, seconds)
    spacing = numpy.median(numpy.asarray(cloud.compute_nearest_neighbor_distance()))
    start = time.time()
    thinned = cloud.voxel_down_sample(2 * spacing)
    mesh = open3d.geometry.TriangleMesh.create_from_point_cloud_ball_pivoting(
        thinned, open3d.utility.DoubleVector([3 * spacing, 6 * spacing, 12 * spacing]))
    seconds = time.time() - start
    open3d.io.write_triangle_mesh(str(folder / "other.ply"), mesh, write_vertex_normals=False)
    row(program, scan, "ball pivoting", folder / "other.ply", truth, seconds)


def main():
    program, data = sys.argv[1], pathlib.Path(sys.argv[2])
    print("| scan | method | mean, %diag | recall | closed | components | loops | self-intersections | seconds |")
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        workflow = folder / "merged.yaml"
        workflow.write_text(MERGED)
        raw = data / "1-bunny/raw"
        views = sorted(raw.glob("*.ply"))
        zipper = open3d.io.read_triangle_mesh(str(data / "1-bunny/bun_zipper.ply"))
        zipper.remove_unreferenced_vertices()
        truth = folder / "truth.ply"
        open3d.io.write_point_cloud(str(truth), open3d.geometry.PointCloud(zipper.vertices))
        run(program, workflow, views, raw / "bun.conf", folder)
        compare(program, "bunny", views, raw / "bun.conf", truth, folder)

        stand = data / "5-raw/happy_stand"
        held_out = [view for view in sorted(stand.glob("*.ply")) if any(view.stem.endswith(end) for end in HELD_OUT)]
        views = [view for view in sorted(stand.glob("*.ply")) if view not in held_out]
        run(program, workflow, held_out, stand / "happyStandRight.conf", folder)
        (folder / "merged.ply").rename(truth)
        run(program, workflow, views, stand / "happyStandRight.conf", folder)
        compare(program, "Buddha", views, stand / "happyStandRight.conf", truth, folder)


main()
