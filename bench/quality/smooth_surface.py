#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""smooth_surface.py PROGRAM: compares the smooth surface of `a-patch` with PyMeshLab's APSS and Open3D's Poisson.

All programs get the points of one scan; APSS and Poisson also get normals with correct signs: Open3D's, of 25
neighbours, on the side of the solid's nearest triangle. Distances are from all points of the scan: `patch-distance`
measures those from the patches, `scanmill measure` those from a mesh. VTK reads the stored patches and evaluates its
own interpolation at vertices of the result of `tessellate`: values near 0 mean that ParaView's contour 0 is our surface.
Writes smooth-surface.md and .json. The exit code is 1 if a program fails, or if more than a tenth of these values are
above 0.1 % of the diagonal.
"""
import pathlib
import sys
import time

import numpy

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

import smooth_normals as truths  # noqa: E402
from harness import machine  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import page, scanmill  # noqa: E402
from tables.ply import write_ply  # noqa: E402

MODELS = {"kitten": "points_3/kitten.xyz", "bunny": "meshes/bunny00.off", "ball": "points_3/ball.ply",
          "armadillo": "meshes/armadillo.off"}
#: Closed models of virtual scans, and the standard deviations of the noise in percent of the diagonal.
ORGANIC = ("bear", "elephant")
NOISES = (0, 0.015, 0.03)
#: Largest errors of the light mesh, in percent of the diagonal.
SHARES = (0.3, 0.1)
#: Cells of APSS's marching cubes along the longest side.
RESOLUTION = 200
DEPTHS = (8, 9)
#: Largest value of VTK's field at this share of the places on our surface, as a share of the diagonal, and their number.
#: At the others two functions hold, of which VTK takes any, or tetrahedra overlap.
LARGEST = 1e-3
MOST = 0.9
PLACES = 5000

NOTES = f"""\
All programs get the points of one scan. *light* is the mesh that `decimate` makes within the max-error, *a-patch* the
smooth surface through its vertices, fitted to the points. PyMeshLab's APSS (filter scale 2) is sampled by marching cubes
with {RESOLUTION} cells along the longest side, Open3D's Poisson runs with two depths; both get normals of 25 neighbours
with correct signs, which a scan without its scanner's positions does not have.

*rms*, *95 %* and *largest* are distances of the scan's points from the surface, in percent of the diagonal. *patches*
counts triangles of the mesh for ours, with the bisected ones, and triangles of the result for the others. *jump* is the largest change of the
normal between neighbours: for a-patch the metric `c1-jump`, for a mesh the 99 % quantile of the angles between
neighbouring triangles. *VTK* is the {100 * MOST:g} % quantile of the values that VTK interpolates in the stored patches at
{PLACES:,} vertices of the result of `tessellate`, in percent of the diagonal; the field is about the distance from the
surface. Beside creases, where two functions hold, VTK takes any of them."""

NORMALS = f"""\
Models that Loop's rule subdivided to at least {truths.LEAST:,} triangles are scanned from 20 views (resolution 0.5 % of the
diagonal). *dense* is the solid through all points, its vertices moved along the true normals by noise (standard deviation in
percent of the diagonal). *light* is *dense* decimated within {SHARES[-1]} %, *a-patch* the surface fitted to the vertices of *dense*. *Patches* are triangles, for
a-patch with the bisected ones. *mean* and *95 %* are angles to the true normals at {truths.SAMPLES:,} random
points: of triangles, and for a-patch of the gradients at the vertices of a tessellation with 8 segments per edge. The
column *of dense* is the mean as a share of the dense mesh's. *rms* is the distance of these points from the truth, in
percent of the diagonal. *visible edges* bend by more than {truths.VISIBLE} degrees, in percent of all edges of the tessellation; in
brackets with its vertices moved to the truth."""


def run_ours(program, file, share, folder, limit):
    """Steps by their names, and the folder's files by their last word."""
    report = scanmill.run(program, BENCH / "quality" / "smooth-surface.yaml", [file], folder, limit,
                          settings={"max-error": f"{share} %diag"})
    cell = report["cells"][0]
    if cell["outcome"] not in ("ok", "doubtful"):
        raise scanmill.Broken(cell.get("error", cell["outcome"]))
    files = {pathlib.Path(one["file"]).stem.rsplit("-", 1)[-1]: one["file"] for one in cell["outputs"]}
    return scanmill.named(report, cell), files


def distances(program, mesh, points, limit):
    """Of the points from the mesh: rms, 95 % and largest; and the mesh's facts."""
    facts = scanmill.measure(program, mesh, points, limit, ["self-intersections=false"])
    return {"rms": facts["rms-from-truth"], "p95": facts["p95-from-truth"], "max": facts["max-from-truth"],
            "patches": int(facts["triangles"]), "closed": facts["closed"]}


def angle_between_neighbours(vertices, triangles):
    """The 99 % quantile, in degrees."""
    import trimesh

    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    return float(numpy.degrees(numpy.quantile(mesh.face_adjacency_angles, 0.99)))


def with_normals(points, solid):
    """An Open3D cloud."""
    import open3d
    import trimesh

    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
    cloud.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(25))
    mesh = trimesh.load(solid, process=False)
    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(numpy.asarray(mesh.vertices, "f4"), numpy.asarray(mesh.faces, "u4"))
    outward = mesh.face_normals[scene.compute_closest_points(points.astype("f4"))["primitive_ids"].numpy()]
    normals = numpy.asarray(cloud.normals)
    normals[(normals * outward).sum(axis=1) < 0] *= -1
    cloud.normals = open3d.utility.Vector3dVector(normals)
    return cloud


def apss(cloud):
    import pymeshlab

    shapes = pymeshlab.MeshSet()
    shapes.add_mesh(pymeshlab.Mesh(numpy.asarray(cloud.points), v_normals_matrix=numpy.asarray(cloud.normals)))
    shapes.generate_marching_cubes_apss(resolution=RESOLUTION)
    made = shapes.current_mesh()
    return made.vertex_matrix(), made.face_matrix()


def poisson(depth):
    def run(cloud):
        import open3d

        made, _ = open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=depth)
        return numpy.asarray(made.vertices), numpy.asarray(made.triangles)

    return run


def vtk_values(patches, points):
    """The values of a stored complex at those of the points that VTK finds in a cell."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkProbeFilter
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(patches)
    reader.Update()
    places, wanted = vtkPoints(), vtkPolyData()
    places.SetData(numpy_to_vtk(points, deep=True))
    wanted.SetPoints(places)
    probe = vtkProbeFilter()
    probe.SetInputData(wanted)
    probe.SetSourceData(reader.GetOutput())
    probe.Update()
    found = probe.GetOutput().GetPointData()
    return vtk_to_numpy(found.GetArray("weights"))[vtk_to_numpy(found.GetArray("vtkValidPointMask")) == 1]


def record_of(name, options):
    import trimesh

    file = options.data / MODELS[name]
    rows, diagonal = [], 0.0
    work = options.program.resolve().parents[2] / "peers" / "smooth-surface" / name
    points_file = work / "points.ply"
    for share in SHARES:
        steps, files = run_ours(options.program, file, share, work / str(share), options.limit)
        points = numpy.asarray(trimesh.load(file, process=False).vertices) if file.suffix != ".xyz" else \
            numpy.loadtxt(file)[:, :3]
        write_ply(points_file, points)
        diagonal = float(numpy.linalg.norm(points.max(axis=0) - points.min(axis=0)))
        light = distances(options.program, files["light"], points_file, options.limit)
        mesh = trimesh.load(files["light"], process=False)
        seconds = sum(steps[one]["seconds"] for one in ("delaunay", "alpha-solid", "solid", "light"))
        rows.append({**light, "name": f"light, {share} %", "seconds": seconds,
                     "jump": f"{angle_between_neighbours(mesh.vertices, mesh.faces):.1f}°"})
        found, made = steps["distances"]["metrics"], steps["surface"]["metrics"]
        smooth = numpy.asarray(trimesh.load(files["smooth"], process=False).vertices)
        values = vtk_values(files["patches"], smooth[:: max(1, len(smooth) // PLACES)])
        rows.append({"name": f"a-patch, {share} %", "rms": found["rms"], "p95": found["p95"], "max": found["max"],
                     "unlocated": int(found["unlocated"]), "closed": True,
                     "patches": int(light["patches"]) + 2 * int(made["refined"]),  # a bisected edge adds two
                     "seconds": seconds + steps["surface"]["seconds"], "jump": f"{made['c1-jump']:.0e}",
                     "vtk": float(numpy.quantile(abs(values), MOST))})
    cloud = with_normals(points, files["solid"])
    for title, make in others().items():
        begin = time.perf_counter()
        vertices, triangles = make(cloud)
        seconds = time.perf_counter() - begin
        write_ply(work / "other.ply", vertices, triangles)
        rows.append({**distances(options.program, work / "other.ply", points_file, options.limit), "name": title,
                     "seconds": seconds, "jump": f"{angle_between_neighbours(vertices, triangles):.1f}°"})
    return {"name": name, "points": len(points), "diagonal": diagonal, "surfaces": rows}


def solid_of_scan(program, truth, folder, limit):
    """The solid through the points of a virtual scan without noise."""
    import trimesh

    folder.mkdir(parents=True, exist_ok=True)
    model = folder / "model.ply"
    write_ply(model, truth.mesh.vertices, truth.mesh.faces)
    for workflow, scan, settings in ((BENCH.parent / "workflows" / "virtual-scans.yaml", model, {"noise": "0 %diag"}),
                                     (BENCH / "quality" / "solid-of-scan.yaml", folder / "virtual-scans" / "model-default.ply", None)):
        into = folder / workflow.stem
        cell = scanmill.run(program, workflow, [scan], into, limit, settings=settings)["cells"][0]
        if cell["outcome"] not in ("ok", "doubtful"):
            raise scanmill.Broken(f"{workflow.name}: {cell.get('error', cell['outcome'])}")
    return trimesh.load(scanmill.mesh(cell)["file"], process=False)


def truth_records_of(name, options):
    """By noise: the angles of all surfaces through a virtual scan of a model."""
    import trimesh

    truth = truths.Truth(options.data / "meshes" / f"{name}.off")
    drawn = {}
    work = options.program.resolve().parents[2] / "peers" / "smooth-surface" / name
    solid = solid_of_scan(options.program, truth, work, options.limit)
    records = []
    for noise in NOISES:
        points, share = truths.with_noise(truth, numpy.asarray(solid.vertices), noise / 100), SHARES[-1]
        file = work / f"noise-{noise}.ply"
        write_ply(file, points, solid.faces)
        report = scanmill.run(options.program, BENCH / "quality" / "smooth-mesh.yaml", [file], work, options.limit,
                              inputs={"scan": file}, settings={"max-error": f"{share} %diag"})
        cell = report["cells"][0]
        if cell["outcome"] not in ("ok", "doubtful"):
            raise scanmill.Broken(cell.get("error", cell["outcome"]))
        steps = scanmill.named(report, cell)
        files = {"dense": file, **{pathlib.Path(one["file"]).stem.rsplit("-", 1)[-1]: one["file"]
                                   for one in cell["outputs"]}}
        meshes = {one: trimesh.load(files[one], process=False) for one in ("dense", "light", "smooth")}
        rows = []
        for title, one in (("dense", "dense"), (f"light, {share} %", "light"), (f"a-patch, {share} %", "smooth")):
            mesh = meshes[one]
            normals = numpy.asarray(mesh.vertex_normals) if one == "smooth" else None
            patches = len(meshes["light" if one == "smooth" else one].faces)
            if one == "smooth":
                patches += 2 * int(steps["surface"]["metrics"]["refined"])  # a bisected edge adds two
            rows.append({"name": title, "patches": patches,
                         **truths.compared(truth, numpy.asarray(mesh.vertices), numpy.asarray(mesh.faces), normals)})
        smooth = meshes["smooth"]
        on_truth, _ = truth.nearest(smooth.vertices)
        rows[-1].update({"visible": truths.share_of_visible_edges(smooth.vertices, smooth.faces),
                         "visible-on-truth": truths.share_of_visible_edges(on_truth, smooth.faces),
                         "seconds": steps["surface"]["seconds"]})
        cloud = with_normals(points, files["dense"])
        for title, make in others().items():
            begin = time.perf_counter()
            vertices, triangles = make(cloud)
            rows.append({"name": title, "patches": len(triangles), "seconds": time.perf_counter() - begin,
                         **truths.compared(truth, vertices, triangles)})
        records.append({"name": name, "noise": noise, "points": len(points), "surfaces": rows})
        drawn[noise] = files["smooth"]
    folder = options.into / "smooth-surface"
    folder.mkdir(exist_ok=True)
    draw(options.program, [drawn[NOISES[0]], drawn[NOISES[-1]], work / "model.ply"], work / "model.ply",
         folder / f"{name}.png", options.limit)
    return records


def draw(program, meshes, truth, into, limit):
    """A picture with the reflection lines of meshes side by side."""
    import open3d

    pictures = []
    for mesh in meshes:
        folder = truth.parent / "drawn"
        report = scanmill.run(program, BENCH / "quality" / "reflection-lines.yaml", [mesh], folder, limit,
                              inputs={"truth": truth})
        pictures.append(numpy.asarray(open3d.io.read_image(report["cells"][0]["outputs"][0]["file"])))
    open3d.io.write_image(str(into), open3d.geometry.Image(numpy.ascontiguousarray(numpy.hstack(pictures))), 9)


def others():
    return {f"PyMeshLab APSS, {RESOLUTION} cells": apss,
            **{f"Open3D Poisson, depth {depth}": poisson(depth) for depth in DEPTHS}}


def lines_of_normals(records):
    lines = ["## Normals", "", NORMALS, ""]
    rows = []
    for record in records:
        dense = record["surfaces"][0]["angle"]
        for row in record["surfaces"]:
            visible = f"{row['visible']:.2f} ({row['visible-on-truth']:.2f})" if "visible" in row else ""
            rows.append([record["name"], f"{record['noise']:g}", row["name"], f"{row['patches']:,}",
                         f"{row['angle']:.2f}°", f"{row['angle95']:.2f}°", f"{row['angle'] / dense:.2f}",
                         f"{100 * row['distance']:.4f}", visible,
                         f"{row['seconds']:.2f}" if "seconds" in row else ""])
    lines += page.table(["model", "noise", "surface", "patches", "mean", "95 %", "of dense", "rms", "visible edges",
                         "seconds"], rows)
    lines += ["", f"Reflection lines of the tessellations, without noise and with {NOISES[-1]} %, and of the truth:", ""]
    for name in dict.fromkeys(record["name"] for record in records):
        lines += [f"![{name}: both surfaces and the truth.](smooth-surface/{name}.png)", ""]
    return lines


def lines_of(results):
    lines = [*page.heading("Smooth surfaces through scans", results, "smooth-surface.json"), NOTES, ""]
    for record in results["models"]:
        lines += [f"## {record['name']}, {record['points']:,} points", ""]
        share = lambda value: f"{100 * value / record['diagonal']:.3g}"
        lines += page.table(
            ["surface", "rms", "95 %", "largest", "patches", "closed", "jump", "seconds", "VTK", "unlocated"],
            [[row["name"], share(row["rms"]), share(row["p95"]), share(row["max"]), f"{row['patches']:,}",
              "yes" if row["closed"] else "no", row["jump"], f"{row['seconds']:.2f}",
              share(row["vtk"]) if "vtk" in row else "", row.get("unlocated", "")]
             for row in record["surfaces"]])
        lines.append("")
    if results["truths"]:
        lines += lines_of_normals(results["truths"])
    return [*lines, page.other_load(results["load"])]


def main():
    parser = options_of.of_a_table("Compares smooth surfaces through scans.", None, 600, "quality")
    parser.add_argument("--models", default=",".join(MODELS), help="names, separated by commas (default: %(default)s)")
    parser.add_argument("--organic", default=",".join(ORGANIC), help="models of virtual scans (default: %(default)s)")
    options = parser.parse_args()
    load = machine.Load()
    records, failed = [], []
    for name in filter(None, options.models.split(",")):
        try:
            records.append(record_of(name, options))
        except scanmill.Broken as failure:
            failed.append(f"{name}: {failure}")
            continue
        failed += [f"{name}: VTK has {row['vtk']:.3g} on the surface {row['name']}"
                   for row in records[-1]["surfaces"] if row.get("vtk", 0) > LARGEST * records[-1]["diagonal"]]
    of_truths = []
    for name in filter(None, options.organic.split(",")):
        try:
            of_truths += truth_records_of(name, options)
        except scanmill.Broken as failure:
            failed.append(f"{name}: {failure}")
    results = {**page.described("make bench-quality"), "load": load.described(), "models": records,
               "truths": of_truths}
    lines = lines_of(results)
    print("\n".join(lines))
    page.write(options.into, "smooth-surface", results, lines)
    for failure in failed:
        print(f"error: {failure}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
