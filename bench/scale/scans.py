# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes batches of many small scans, each a different one."""
import math
import pathlib
import random
import struct

WORKFLOW = """scanmill: 1
name: mesh
inputs: {scan: points}
steps:
  - delaunay:
  - alpha-solid: {alpha: {sweep: [auto, 40 u]}}
outputs:
  "{scan}-{variant}.ply": alpha-solid
"""


def write_scan(file, points, seed):
    """Points on an ellipsoid whose half axes depend on the seed."""
    chance = random.Random(seed)
    axes = [chance.uniform(20, 40) for _ in range(3)]
    rows = []
    for _ in range(points):
        direction = [chance.gauss(0, 1) for _ in range(3)]
        length = math.sqrt(sum(value * value for value in direction))
        rows.append(struct.pack("<3d", *(axis * value / length for axis, value in zip(axes, direction))))
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {points}\n"
            "property double x\nproperty double y\nproperty double z\nend_header\n")
    file.write_bytes(head.encode() + b"".join(rows))


def write_batch(folder, name, scans, points=400):
    """A batch file `name`.yaml with `scans` scans and two variants of each. Returns its path."""
    folder = pathlib.Path(folder)
    (folder / name).mkdir(parents=True)
    for number in range(scans):
        write_scan(folder / name / f"{number:07}.ply", points, number)
    (folder / "mesh.yaml").write_text(WORKFLOW)
    batch = folder / f"{name}.yaml"
    batch.write_text(f'scanmill: 1\nbatch: {name}\nscans: ["{name}/*.ply"]\nworkflows: [mesh.yaml]\ngate: {{genus: exact}}\n')
    return batch
