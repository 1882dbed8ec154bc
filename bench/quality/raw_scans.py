#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""raw_scans.py PROGRAM: makes meshes of virtual scans by our workflows and Open3D, and compares them with the models.

Every model is scanned from 20 views, without noise and with noise of 0.05 % of its diagonal. The workflows
quickstart and raw-scans get the points alone; so does Open3D's ball pivoting, after its own thinning, and Poisson with
normals of correct signs. Writes raw-scans.md and .json. The exit code is 1 if a program fails, or if one of our
results misses a goal (see MISSES) without being doubtful.

--quick scans four models coarsely, and writes into a folder under build/.
"""
import hashlib
import json
import pathlib
import sys
import time

import numpy

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

from harness import machine  # noqa: E402
from raw_scans_page import KEEP, OURS, lines_of, misses  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import page, scanmill  # noqa: E402
from tables.ply import write_ply  # noqa: E402

#: Open ones have boundary loops.
MODELS = ["armadillo", "bunny00", "camel", "elephant", "hand", "homer", "knot1", "triceratops",  # organic
          "anchor_dense", "couplingdown", "fandisk_large", "rotor_small", "turbine",  # mechanical
          "lion-head", "mannequin-devil", "mech-holes-shark", "three_peaks"]  # open
QUICK = ["camel", "knot1", "anchor_dense", "lion-head"]
#: Standard deviations, in percent of the diagonal.
NOISES = [0, 0.05]
#: Edge of the voxels of ball pivoting, in percent of the diagonal.
VOXEL = 0.5
DEPTH = 8
#: Of ball pivoting, in mean distances of nearest neighbours.
RADII = (1, 1.5, 2, 3)
NEIGHBOURS = 25
SAMPLES = 50_000


def scanned(program, model, noise, resolution, folder, limit):
    """The points of the views."""
    import trimesh

    settings = {"noise": f"{noise} %diag", "resolution": f"{resolution} %diag"}
    report = scanmill.run(program, BENCH / "quality" / "raw-views.yaml", [model], folder, limit, settings=settings)
    outputs = report["cells"][0]["outputs"]
    if not outputs:
        raise scanmill.Broken(f"virtual-scan made no points of {model}")
    file = outputs[0]["file"]
    return numpy.asarray(trimesh.load(file, process=False).vertices)


def judged(program, mesh, model, limit):
    """The facts of a mesh, distances in percent of the model's diagonal."""
    facts = scanmill.measure(program, mesh, model, limit, [f"samples={SAMPLES}", "same-frame=true"])
    import trimesh

    share = 100 / float(numpy.linalg.norm(trimesh.load(model, process=False).extents))
    counts = {"pieces": "components", "loops": "boundary-loops", "triangles": "triangles",
              "intersections": "self-intersections"}
    found = {"mean": share * facts["mean"], "largest": share * facts["hausdorff"], "f_score": facts["f-score"],
             **{name: int(facts[metric]) for name, metric in counts.items()}}
    found["genus"] = int(facts["genus"]) if "genus" in facts else None
    return found


def truth_of(program, model, limit):
    facts = scanmill.measure(program, model, model, limit, ["samples=100", "same-frame=true"])
    return {"pieces": int(facts["components"]), "loops": int(facts["boundary-loops"]), "genus": int(facts["genus"]),
            "intersections": int(facts["self-intersections"]), "triangles": int(facts["triangles"])}


def ours(program, workflow, points, model, folder, limit, settings=None):
    """The facts of the workflow's mesh; only those of the run if there is none."""
    report = scanmill.run(program, workflow, [points], folder, limit, settings=settings)
    cell = report["cells"][0]
    steps = scanmill.steps(report, cell)
    facts = {"outcome": cell["outcome"], "seconds": sum(step.get("seconds", 0) for step in steps.values())}
    if "error" in cell:
        facts["reason"] = cell["error"]["message"] if isinstance(cell["error"], dict) else cell["error"]
    if grown := steps.get("region-grow", {}).get("metrics"):
        facts["grown"] = {name: int(grown[name]) for name in ("components", "loops", "thin-loops")}
    meshes = [one["file"] for one in cell.get("outputs", []) if one["kind"] == "mesh" and one["outcome"] == "ok"]
    return {**facts, **judged(program, meshes[0], model, limit)} if meshes else facts


def with_normals(points, model):
    """An Open3D cloud with normals on the side of the model's nearest triangle."""
    import open3d
    import trimesh

    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
    cloud.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(NEIGHBOURS))
    mesh = trimesh.load(model, process=False)
    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(numpy.asarray(mesh.vertices, "f4"), numpy.asarray(mesh.faces, "u4"))
    outward = mesh.face_normals[scene.compute_closest_points(points.astype("f4"))["primitive_ids"].numpy()]
    normals = numpy.asarray(cloud.normals)
    normals[(normals * outward).sum(axis=1) < 0] *= -1
    cloud.normals = open3d.utility.Vector3dVector(normals)
    return cloud


def poisson(cloud):
    import open3d

    return open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=DEPTH)[0]


def ball_pivoting(cloud):
    import open3d

    diagonal = numpy.linalg.norm(cloud.get_max_bound() - cloud.get_min_bound())
    thinned = cloud.voxel_down_sample(VOXEL / 100 * diagonal)
    spacing = numpy.mean(thinned.compute_nearest_neighbor_distance())
    radii = open3d.utility.DoubleVector([factor * spacing for factor in RADII])
    return open3d.geometry.TriangleMesh.create_from_point_cloud_ball_pivoting(thinned, radii)


def others(program, points, model, folder, limit):
    """Of the peers by name: facts."""
    found = {}
    begin = time.perf_counter()
    cloud = with_normals(points, model)
    normals = time.perf_counter() - begin
    for name, make in {"Poisson": poisson, "ball pivoting": ball_pivoting}.items():
        begin = time.perf_counter()
        mesh = make(cloud)
        seconds = normals + time.perf_counter() - begin
        file = folder / f"{name.replace(' ', '-')}.ply"
        write_ply(file, numpy.asarray(mesh.vertices), numpy.asarray(mesh.triangles))
        found[name] = {"seconds": seconds, **judged(program, file, model, limit)}
    return found


def remembered(file, key, make):
    """The result of `make()`, from the file if it was made with the same key."""
    if file.exists() and (kept := json.loads(file.read_text()))["key"] == key:
        return kept["result"]
    result = make()
    file.write_text(json.dumps({"key": key, "result": result}))
    return result


def record_of(name, noise, options, work):
    """One scan, and the facts of all meshes made of it."""
    program, limit = options.program, options.limit
    model = options.data / "meshes" / f"{name}.off"
    folder = work / f"{name}-{noise}"
    folder.mkdir(parents=True, exist_ok=True)
    points = scanned(program, model, noise, options.resolution, folder, limit)
    scan = folder / "scan.ply"
    write_ply(scan, points)
    key = hashlib.sha256(points.tobytes() + repr((VOXEL, DEPTH, RADII, NEIGHBOURS, SAMPLES)).encode()).hexdigest()
    surfaces = {workflow: ours(program, options.workflows / f"{workflow}.yaml", scan, model, folder / workflow, limit)
                for workflow in OURS}
    truth = truth_of(program, model, limit)
    if truth["loops"] > 0:
        surfaces[KEEP] = ours(program, options.workflows / "raw-scans.yaml", scan, model, folder / "keep", limit,
                              {"outer": "keep"})
    surfaces.update(remembered(folder / "others.json", key, lambda: others(program, points, model, folder, limit)))
    return {"name": name, "noise": noise, "points": len(points), "truth": truth,
            "surfaces": surfaces}


def main():
    parser = options_of.of_a_table("Compares meshes of virtual scans with the models.", None, 900, "quality")
    parser.add_argument("--models", help="names, separated by commas")
    parser.add_argument("--quick", action="store_true", help="four models, scanned coarsely")
    parser.add_argument("--workflows", type=pathlib.Path, default=BENCH.parent / "workflows", help="their folder")
    options = parser.parse_args()
    work = options.program.resolve().parents[2] / "peers" / ("raw-scans-quick" if options.quick else "raw-scans")
    options.resolution = 0.8 if options.quick else 0.5
    names = options.models.split(",") if options.models else QUICK if options.quick else MODELS
    load = machine.Load()
    records, failed = [], []
    for name in names:
        for noise in NOISES:
            try:
                records.append(record_of(name, noise, options, work))
            except scanmill.Broken as failure:
                failed.append(f"{name}, noise {noise} %: {failure}")
                continue
            for workflow in (name for name in records[-1]["surfaces"] if name in (*OURS, KEEP)):
                found = misses(records[-1], workflow)
                outcome = records[-1]["surfaces"][workflow]["outcome"]
                print(f"{name}, noise {noise} %, {workflow}: {outcome}" + "".join(f"; {miss}" for miss in found),
                      file=sys.stderr, flush=True)
                if found and outcome == "ok":
                    failed.append(f"{name}, noise {noise} %, {workflow}: {', '.join(found)}, but not doubtful")
    results = {**page.described("make bench-quality"), "load": load.described(), "records": records}
    lines = lines_of(results)
    print("\n".join(lines))
    page.write(work if options.quick or options.models else options.into, "raw-scans", results, lines)
    for failure in failed:
        print(f"error: {failure}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
