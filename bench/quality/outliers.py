#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""outliers.py PROGRAM: adds outliers, uniform in the doubled box, to what `outlier-removal` keeps of clean scans. Prints a
table of how many of them a second `outlier-removal` leaves, and how many points of the scan it loses. Needs the scans
of `make data`."""
import pathlib
import random
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCANS = {
    "bunny": "meshes/bunny00.off", "armadillo": "meshes/armadillo.off", "kitten": "points_3/kitten.xyz",
    "fandisk, exact vertices of a CAD model": "meshes/fandisk_large.off", "camel, uneven": "meshes/camel.off",
    "bull, uneven": "meshes/bull.off", "anchor": "meshes/anchor_dense.off",
}
SHARES = (0.05, 0.5, 1.0)
WORKFLOW = """\
scanmill: 1
name: outliers
inputs: {scan: points}
steps: [outlier-removal: ]
outputs: {"kept.xyz": outlier-removal}
"""


def kept(program, file, folder):
    """The positions that are left of a file."""
    (folder / "outliers.yaml").write_text(WORKFLOW)
    subprocess.run([program, "run", "outliers.yaml", file, "-o", ".", "-q"], cwd=folder, check=True,
                   capture_output=True)
    with open(folder / "kept.xyz") as lines:
        return [tuple(float(word) for word in line.split()[:3]) for line in lines]


def left_and_lost(program, points, count, folder):
    """Numbers of outliers that are kept, and of distinct points that are not."""
    generator = random.Random(5)
    low, high = ([bound(p[axis] for p in points) for axis in range(3)] for bound in (min, max))
    outliers = {tuple(generator.uniform(1.5 * a - 0.5 * b, 1.5 * b - 0.5 * a) for a, b in zip(low, high))
                for _ in range(count)}
    with open(folder / "dirty.xyz", "w") as file:
        file.writelines("%r %r %r\n" % p for p in [*points, *sorted(outliers)])
    found = set(kept(program, folder / "dirty.xyz", folder))
    return len(found & outliers), len(set(points) - found)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    program = pathlib.Path(sys.argv[1]).resolve()
    print("| scan | points |" + "".join(f" {share:.0%} | left, lost |" for share in SHARES).replace("%", " %"))
    print("|---|---|" + "---|---|" * len(SHARES))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for scan, file in SCANS.items():
            points = kept(program, ROOT / "build" / "data" / file, folder)
            cells = []
            for share in SHARES:
                count = int(share * len(points))
                left, lost = left_and_lost(program, points, count, folder)
                cells.append(f" {count:,} | {left:,}, {lost:,} |")
            print(f"| {scan} | {len(points):,} |" + "".join(cells), flush=True)


if __name__ == "__main__":
    main()
