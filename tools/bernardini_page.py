#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""bernardini_page.py PROGRAM SCAN FOLDER: writes docs/bernardini-1997.md and its pictures: the stages of
workflows/bernardini-1997.yaml on one scan, as in Figure 1 of Bernardini et al. 1997, with the numbers of the run.
Values of the workflow are written into FOLDER."""
import colorsys
import json
import pathlib
import subprocess
import sys

from shaded import View, corners, cross, minus, position, read_ply, unit

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGES = ROOT / "docs" / "bernardini-1997"
STONE, INK = (214, 208, 196), (60, 60, 70)
TOWARDS, UP = (0.45, 0.25, 0.85), (0, 1, 0)

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
               "scan's points have the distance {rms:.3g} from it on average (root mean square, {rms_share:.2g} % of the "
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


def view_of(points):
    return View(points, TOWARDS, UP)


def mesh_picture(ply, points, name, edges=False):
    vertices = [position(row) for row in ply["vertex"]]
    view = view_of(points)
    for row in ply["face"]:
        a, b, c = (vertices[i] for i in corners(row))
        normal = unit(cross(minus(b, a), minus(c, a)))
        view.triangle(a, b, c, STONE, [normal] * 3)
        if edges:
            for p, q in ((a, b), (b, c), (c, a)):
                view.line(p, q, INK)
    view.write(PAGES / f"{name}.png")


def smooth_picture(ply, points, name, coloured):
    vertices = [position(row) for row in ply["vertex"]]
    normals = [(row["nx"], row["ny"], row["nz"]) for row in ply["vertex"]]
    view = view_of(points)
    for row in ply["face"]:
        colour = STONE
        if coloured:
            hue = row["patch"] * 0.618 % 1
            colour = tuple(int(255 * part) for part in colorsys.hls_to_rgb(hue, 0.65, 0.55))
        a, b, c = corners(row)
        view.triangle(vertices[a], vertices[b], vertices[c], colour, [normals[a], normals[b], normals[c]])
    view.write(PAGES / f"{name}.png")


def hull_picture(document, points, name):
    """Every second tetrahedron over a triangle, and the light mesh's triangles below."""
    view = view_of(points)
    places = document["points"]
    for tet in document["tets"]:
        if tet["side"] != 1 or tet["kind"] != "face":
            continue
        base, i, j, apex = (places[vertex] for vertex in tet["vertices"])
        view.triangle(base, i, j, STONE, [unit(cross(minus(i, base), minus(j, base)))] * 3)
        if tet["patch"] % 2:
            continue
        for p, q in ((i, j), (i, apex), (j, apex)):
            view.line(p, q, INK, 0.1)
        for a, b, c in ((base, i, apex), (base, j, apex), (i, j, apex)):
            view.triangle(a, b, c, (160, 196, 214), [unit(cross(minus(b, a), minus(c, a)))] * 3)
    view.write(PAGES / f"{name}.png")


def main():
    program, scan, folder = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    report = run(program, scan, folder)
    cell = report["cells"][0]
    steps = {report["steps"][number]["step"]: report["steps"][number] for number in cell["steps"]}
    files = {pathlib.Path(one["file"]).name: one["file"] for one in cell["outputs"]}
    surface, light, smooth = (read_ply(files[f"{scan.stem}{part}.ply"]) for part in ("", "-light", "-smooth"))
    with open(files[f"{scan.stem}-patches.json"]) as file:
        patches = json.load(file)
    points = [position(row) for row in surface["vertex"]]

    PAGES.mkdir(exist_ok=True)
    view = view_of(points)
    for p in points:
        view.point(p, INK)
    view.write(PAGES / "points.png")
    mesh_picture(surface, points, "surface")
    mesh_picture(light, points, "light", edges=True)
    hull_picture(patches, points, "hull")
    smooth_picture(smooth, points, "patches", coloured=True)
    smooth_picture(smooth, points, "smooth", coloured=False)

    metrics = {name: step.get("metrics", {}) for name, step in steps.items()}
    near = measured(program, files[f"{scan.stem}-smooth.ply"], scan)
    before = measured(program, files[f"{scan.stem}-light.ply"], scan)
    diagonal = near["diagonal"]
    error = max(metrics["light"]["hausdorff-upper"], metrics["light"]["points-max"])
    numbers = {
        "points": int(steps["read"]["properties"]["points"]), "cells": int(metrics["delaunay"]["cells"]),
        "kept": int(metrics["alpha-solid"]["cells"]), "alpha": metrics["alpha-solid"]["alpha"],
        "alpha_share": 100 * metrics["alpha-solid"]["alpha"] / diagonal, "carved": int(metrics["surface"]["removed"]),
        "triangles": len(surface["face"]), "light": len(light["face"]), "error": error,
        "error_share": 100 * error / diagonal, "tets": int(metrics["a-patch"]["tetrahedra"]),
        "jump": metrics["a-patch"]["c1-jump"], "smooth": len(smooth["face"]), "rms": near["rms-from-truth"],
        "rms_share": 100 * near["rms-from-truth"] / diagonal, "light_rms": before["rms-from-truth"],
    }
    lines = ["<!-- Generated by `make paper`. Do not edit. -->", "# Bernardini, Bajaj, Chen and Schikore 1997 on one scan", "",
             "Figure 1 of the paper shows every stage of its pipeline on one object. This page does the same with",
             f"`{scan.name}`, which `make data` fetches, and with `workflows/bernardini-1997.yaml`; `make paper` makes it.", ""]
    for name, (title, text) in TEXTS.items():
        lines += [f"## {title}", "", text.format(**numbers), "", f"![{title}](bernardini-1997/{name}.png)", ""]
    (ROOT / "docs" / "bernardini-1997.md").write_text("\n".join(lines).rstrip() + "\n")


if __name__ == "__main__":
    main()
