#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""fair_surface.py PROGRAM: angles between the normals of smooth surfaces and the true ones, on shapes of fair_shapes.py.

Runs smooth-surface.yaml on the vertices of dense meshes with noise, and prints a table for the page of a-patch: mean
angles of the dense mesh, the light mesh and the tessellated surface at random points, in degrees, and the rms distance
of the surface from the truth as a share of the light mesh's.
"""
import pathlib
import subprocess
import sys
import tempfile

import fair_shapes
import numpy
import trimesh

WORKFLOW = pathlib.Path(__file__).with_name("smooth-surface.yaml")
#: Shape, edge of the cells of the dense mesh, noise and largest errors of the light mesh in percent of the diagonal.
CASES = (("limbs", 0.035, 0, (0.1, 0.3)), ("limbs", 0.0245, 0.015, (0.1,)), ("limbs", 0.029, 0.03, (0.1,)),
         ("bumps", 0.033, 0, (0.1,)), ("bumps", 0.023, 0.015, (0.3,)), ("torus", 0.04, 0, (0.1,)),
         ("torus", 0.04, 0.015, (0.1,)))
SAMPLES = 15000


def compared(shape, mesh):
    """Mean angle to the true normals, and rms distance from the truth, at random points of a mesh."""
    points, faces = trimesh.sample.sample_surface(mesh, SAMPLES, seed=1)
    truth = fair_shapes.on_surface(shape, points)
    cosines = (mesh.face_normals[faces] * fair_shapes.normals(shape, truth)).sum(1)
    angles = numpy.degrees(numpy.arccos(numpy.clip(cosines, -1, 1)))
    return angles.mean(), numpy.sqrt(((points - truth) ** 2).sum(1).mean())


def main():
    program = sys.argv[1]
    print("| shape | noise | decimated within | patches | dense | light | surface | distance |")
    for shape, cell, noise, errors in CASES:
        points, triangles = fair_shapes.dense(shape, cell, noise)
        dense = trimesh.Trimesh(points, triangles, process=False)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "scan.ply"
            file.write_bytes(trimesh.exchange.ply.export_ply(dense))
            for error in errors:
                subprocess.run([program, "run", WORKFLOW, file, "-o", folder, "--no-cache", "--quiet", "--unit", "mm",
                                "--set", f"max-error={error} %diag", "--set", "segments=16"], check=True, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
                light, smooth = (trimesh.load(pathlib.Path(folder) / f"scan-{name}.ply", process=False)
                                 for name in ("light", "smooth"))
                (of_dense, _), (of_light, far), (angle, near) = (compared(shape, each)
                                                                 for each in (dense, light, smooth))
                print(f"| {shape} | {noise} % | {error} % | {len(light.faces):,} | {of_dense:.2f}° | {of_light:.2f}° "
                      f"| {angle:.2f}° | {near / far:.3f} |", flush=True)


if __name__ == "__main__":
    main()
