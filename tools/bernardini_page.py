#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""bernardini_page.py PROGRAM SCAN FOLDER: writes docs/bernardini-1997.md and its pictures: the stages of
workflows/bernardini-1997.yaml on one scan, as in Figure 1 of Bernardini et al. 1997, with the numbers of the run.
Values of the workflow are written into FOLDER."""
import base64
import json
import pathlib
import struct
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGES = ROOT / "docs" / "bernardini-1997"
SIZE = "[640, 560]"
#: The pictures by name: the file that is drawn, its kind, and the parameters of `render`.
PICTURES = {
    "points": ("{scan}", "points", ""),
    "surface": ("{stem}.ply", "mesh", ""),
    "light": ("{stem}-light.ply", "mesh", ", edges: true"),
    "hull": ("{stem}-hull.off", "mesh", ", edges: true"),
    "patches": ("{stem}-smooth.ply", "mesh", ", colour: patch, legend: false"),
    "smooth": ("{stem}-smooth.ply", "mesh", ", style: lines"),
}

TEXTS = {
    "points": ("The scan", "{points:,} points, without normals and without order."),
    "surface": ("The solid", "`delaunay` makes {cells:,} tetrahedra of the points, `alpha-solid` keeps {kept:,} of them "
                "with alpha {alpha:.3g} ({alpha_share:.2g} % of the diagonal), and `sculpt` removes {carved:,} of "
                "them, where they bridge concave places. The boundary has {triangles:,} triangles and passes through all points."),
    "light": ("The light mesh", "`decimate` keeps {light:,} triangles. No point of either mesh, and no point of the scan, "
              "is farther than {error:.3g} ({error_share:.2g} % of the diagonal) from the other: proven, not sampled."),
    "hull": ("The support of the patches", "`a-patch` erects {tets:,} tetrahedra on both sides of the light mesh; the "
             "picture has those outside, some left out. Each carries one cubic polynomial."),
    "patches": ("The patches", "Where the polynomials are 0 is the surface: a patch over every triangle, and strips between "
                "them. Their gradients differ by at most {jump:.0e} of their length where two tetrahedra meet."),
    "smooth": ("The surface", "`tessellate` makes {smooth:,} triangles of it for other programs, with exact normals. The "
               "picture shows the bands that it would reflect. The scan's points have the distance {rms:.3g} from it on average (root mean square, {rms_share:.2g} % of the "
               "diagonal); from the light mesh it is {light_rms:.3g}."),
}


def run(program, scan, folder):
    report = subprocess.run([program, "run", ROOT / "workflows" / "bernardini-1997.yaml", scan, "-o", folder,
                             "--no-cache", "--quiet", "--json"], stdout=subprocess.PIPE, text=True, check=True)
    return json.loads(report.stdout)


def measured(program, mesh, scan):
    printed = subprocess.run([program, "measure", mesh, scan, "--json", "--set", "self-intersections=false"],
                             stdout=subprocess.PIPE, text=True, check=True)
    return json.loads(printed.stdout)["metrics"]


def triangles_of(cell, name):
    """The number of triangles in the output with this name."""
    return next(int(one["properties"]["triangles"]) for one in cell["outputs"] if pathlib.Path(one["file"]).name == name)


def write_hull(patches, file):
    """Every second tetrahedron over a triangle of the light mesh, and the triangles, as an OFF file."""
    places, tets, sides, kinds, rows = (
        list(struct.iter_unpack(row, base64.b64decode(patches[name])))
        for name, row in (("points", "<3d"), ("tets", "<4I"), ("side", "<B"), ("kind", "<B"), ("patch", "<I")))
    triangles = []
    for (base, i, j, apex), (side,), (kind,), (row,) in zip(tets, sides, kinds, rows):
        if side == 1 and kind == 0:  # outside, over a triangle
            triangles.append((base, i, j))
            if row % 2 == 0:
                triangles += [(i, apex, base), (base, apex, j), (j, apex, i)]
    lines = ["OFF", f"{len(places)} {len(triangles)} 0"]
    lines += [f"{x} {y} {z}" for x, y, z in places]
    lines += [f"3 {a} {b} {c}" for a, b, c in triangles]
    file.write_text("\n".join(lines) + "\n")


def draw(program, scan, folder):
    """Draws all pictures with the camera of the solid."""
    for name, (pattern, kind, parameters) in PICTURES.items():
        file = pattern.format(scan=scan, stem=folder / scan.stem)
        workflow = folder / f"draw-{name}.yaml"
        workflow.write_text(f"scanmill: 1\nname: {name}\ninputs: {{scene: {kind}, solid: mesh}}\nsteps:\n"
                            f"  - render: {{up: y, size: {SIZE}{parameters}}}\n"
                            f"    in: {{scene: scene, truth: solid}}\noutputs: {{{name}.png: render}}\n")
        subprocess.run([program, "run", workflow, file, "--in", f"solid={folder / scan.stem}.ply", "-o", folder, "--quiet",
                        "--no-cache"], stdout=subprocess.DEVNULL, check=True)
        (PAGES / f"{name}.png").write_bytes((folder / f"{name}.png").read_bytes())


def main():
    program, scan, folder = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    report = run(program, scan, folder)
    cell = report["cells"][0]
    steps = {report["steps"][number]["step"]: report["steps"][number] for number in cell["steps"]}
    files = {pathlib.Path(one["file"]).name: one["file"] for one in cell["outputs"]}
    with open(files[f"{scan.stem}-patches.json"]) as file:
        patches = json.load(file)
    write_hull(patches, folder / f"{scan.stem}-hull.off")
    PAGES.mkdir(exist_ok=True)
    draw(program, scan, folder)

    metrics = {name: step.get("metrics", {}) for name, step in steps.items()}
    near = measured(program, files[f"{scan.stem}-smooth.ply"], scan)
    before = measured(program, files[f"{scan.stem}-light.ply"], scan)
    diagonal = near["diagonal"]
    error = max(metrics["light"]["hausdorff-upper"], metrics["light"]["points-max"])
    numbers = {
        "points": int(steps["read"]["properties"]["points"]), "cells": int(metrics["delaunay"]["cells"]),
        "kept": int(metrics["alpha-solid"]["cells"]), "alpha": metrics["alpha-solid"]["alpha"],
        "alpha_share": 100 * metrics["alpha-solid"]["alpha"] / diagonal, "carved": int(metrics["surface"]["removed"]),
        "triangles": triangles_of(cell, f"{scan.stem}.ply"), "light": triangles_of(cell, f"{scan.stem}-light.ply"), "error": error,
        "error_share": 100 * error / diagonal, "tets": int(metrics["a-patch"]["tetrahedra"]),
        "jump": metrics["a-patch"]["c1-jump"], "smooth": triangles_of(cell, f"{scan.stem}-smooth.ply"), "rms": near["rms-from-truth"],
        "rms_share": 100 * near["rms-from-truth"] / diagonal, "light_rms": before["rms-from-truth"],
    }
    lines = ["<!-- Generated by `make paper`. Do not edit. -->", "# Bernardini, Bajaj, Chen and Schikore 1997 on one scan", "",
             "Figure 1 of the paper shows every stage of its pipeline on one object. This page does the same with",
             f"`{scan.name}`, which `make data` fetches, and with `workflows/bernardini-1997.yaml`; `make paper` makes it.",
             "The workflow passes through the points of a clean, dense scan without outliers and noise. For everything else there",
             "is [bernardini-1997-raw](../workflows/bernardini-1997-raw.yaml), which cleans the points as `raw-scans` does.", ""]
    for name, (title, text) in TEXTS.items():
        lines += [f"## {title}", "", text.format(**numbers), "", f"![{title}](bernardini-1997/{name}.png)", ""]
    (ROOT / "docs" / "bernardini-1997.md").write_text("\n".join(lines).rstrip() + "\n")


if __name__ == "__main__":
    main()
