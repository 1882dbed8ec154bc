#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""raw_views.py PROGRAM: makes meshes of the raw views of two objects by our workflows and Open3D.

The Stanford bunny's ten views are compared with the points of its merged mesh, the Happy Buddha's fifteen standing
views with the points of three of them (24, 144 and 264 degrees), which no program gets. Writes raw-views.md and .json.
The exit code is 1 if a program fails, or if one of our results misses a goal without being doubtful. Does nothing if
the folder of --more-data does not have the views.
"""
import pathlib
import sys
import time

import numpy

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

from harness import machine  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import page, scanmill  # noqa: E402
from tables.ply import write_ply  # noqa: E402

WORKFLOWS = BENCH.parent / "workflows"
HELD_OUT = ("_24", "_144", "_264")
DEPTH = 8
#: Of ball pivoting, in spacings; it gets points thinned to two spacings.
RADII = (3, 6, 12)
THINNED = 2
#: Recall may be lower by this than that of the others.
ALLOWED = 0.001

NOTES = f"""\
*raw-scans* gets the views and their poses, *quickstart* the merged points; both at their defaults. Open3D gets the
merged points without outliers, with the normals of our filter `normals` (40 neighbours): *Poisson* with depth {DEPTH},
*ball pivoting* thinned to two spacings, with radii of 3, 6 and 12 spacings.

*mean* and *largest* are distances of the true points from the mesh, in percent of its diagonal, without the points
nearest to a boundary (`measure` with `borders: exclude`). *recall* is the share of the points nearer than 0.5 % of the
diagonal. *misses* names the goals that one of our results misses: *mean* below that of both others, *recall* at most
{100 * ALLOWED:g} percent points lower, *closed*, one of *pieces*, no pairs of intersecting triangles (*cuts*)."""


def facts_of(program, mesh, truth, limit):
    found = scanmill.measure(program, mesh, truth, limit, ["borders=exclude"])
    share = 100 / found["diagonal"]
    return {"mean": share * found["mean-from-truth"], "largest": share * found["max-from-truth"],
            "recall": found["recall"], "closed": bool(found["closed"]), "pieces": int(found["components"]),
            "genus": int(found["genus"]) if "genus" in found else None, "loops": int(found["boundary-loops"]),
            "cuts": int(found["self-intersections"]), "triangles": int(found["triangles"])}


def cell_of(program, workflow, scans, folder, limit, poses=None):
    report = scanmill.run(program, workflow, scans, folder, limit, settings={"poses": poses} if poses else None)
    return report["cells"][0]


def merged(program, views, poses, folder, limit):
    """The file with the merged points and their normals."""
    cell = cell_of(program, BENCH / "quality" / "merged-views.yaml", views, folder, limit, poses)
    if not cell["outputs"]:
        raise scanmill.Broken(f"merging {len(views)} views failed: {cell.get('error')}")
    return pathlib.Path(cell["outputs"][0]["file"])


def ours(program, workflow, scans, folder, truth, limit, poses=None):
    cell = cell_of(program, WORKFLOWS / f"{workflow}.yaml", scans, folder, limit, poses)
    facts = {"outcome": cell["outcome"], "seconds": cell["seconds"]}
    meshes = [one["file"] for one in cell["outputs"] if one["kind"] == "mesh" and one["outcome"] == "ok"]
    return {**facts, **facts_of(program, meshes[0], truth, limit)} if meshes else facts


def others(program, points, folder, truth, limit):
    import open3d

    cloud = open3d.io.read_point_cloud(str(points))
    spacing = numpy.median(numpy.asarray(cloud.compute_nearest_neighbor_distance()))
    radii = open3d.utility.DoubleVector([factor * spacing for factor in RADII])
    kind = open3d.geometry.TriangleMesh
    makers = {"Poisson": lambda: kind.create_from_point_cloud_poisson(cloud, depth=DEPTH)[0],
              "ball pivoting": lambda: kind.create_from_point_cloud_ball_pivoting(
                  cloud.voxel_down_sample(THINNED * spacing), radii)}
    found = {}
    for name, make in makers.items():
        begin = time.perf_counter()
        mesh = make()
        seconds = time.perf_counter() - begin
        file = folder / f"{name.replace(' ', '-')}.ply"
        write_ply(file, numpy.asarray(mesh.vertices), numpy.asarray(mesh.triangles))
        found[name] = {"seconds": seconds, **facts_of(program, file, truth, limit)}
    return found


def misses(surfaces, name):
    mine, rest = surfaces[name], (surfaces["Poisson"], surfaces["ball pivoting"])
    if "mean" not in mine:
        return ["no mesh"]
    goals = {"mean": all(mine["mean"] < other["mean"] for other in rest),
             "recall": all(mine["recall"] >= other["recall"] - ALLOWED for other in rest),
             "closed": mine["closed"], "pieces": mine["pieces"] == 1, "cuts": mine["cuts"] == 0}
    return [goal for goal, holds in goals.items() if not holds]


def record_of(program, name, views, poses, truth, folder, limit):
    points = merged(program, views, poses, folder / "merged", limit)
    surfaces = {"raw-scans": ours(program, "raw-scans", views, folder / "raw-scans", truth, limit, poses),
                "quickstart": ours(program, "quickstart", [points], folder / "quickstart", truth, limit),
                **others(program, points, folder, truth, limit)}
    return {"name": name, "views": len(views), "surfaces": surfaces}


def bunny(program, data, folder, limit):
    import open3d

    raw = data / "1-bunny" / "raw"
    mesh = open3d.io.read_triangle_mesh(str(data / "1-bunny" / "bun_zipper.ply"))
    mesh.remove_unreferenced_vertices()
    folder.mkdir(parents=True, exist_ok=True)
    truth = folder / "truth.ply"
    write_ply(truth, numpy.asarray(mesh.vertices))
    return record_of(program, "bunny", sorted(raw.glob("*.ply")), raw / "bun.conf", truth, folder, limit)


def buddha(program, data, folder, limit):
    stand = data / "5-raw" / "happy_stand"
    poses = stand / "happyStandRight.conf"
    views = sorted(stand.glob("*.ply"))
    kept = [view for view in views if not view.stem.endswith(HELD_OUT)]
    truth = merged(program, [view for view in views if view not in kept], poses, folder / "truth", limit)
    return record_of(program, "Happy Buddha", kept, poses, truth, folder, limit)


def lines_of(results):
    lines = [*page.heading("Meshes of raw views", results, "raw-views.json"), NOTES, ""]
    for record in results["records"]:
        rows = []
        for name, facts in record["surfaces"].items():
            words = [facts["outcome"], ", ".join(misses(record["surfaces"], name))] if "outcome" in facts else ["", ""]
            found = ["", "", "", "", "", "", ""]
            if "mean" in facts:
                found = [f"{facts['mean']:.4f}", f"{facts['largest']:.2f}", f"{facts['recall']:.4f}", facts["pieces"],
                         facts["loops"], "" if facts["genus"] is None else facts["genus"], facts["cuts"]]
            rows.append([name, *found, f"{facts.get('triangles', 0):,}", f"{facts['seconds']:.1f}", *words])
        lines += [f"## {record['name']}, {record['views']} views", ""]
        lines += page.table(["surface", "mean", "largest", "recall", "pieces", "loops", "genus", "cuts", "triangles",
                             "seconds", "outcome", "misses"], rows)
        lines.append("")
    return [*lines, page.other_load(results["load"])]


def main():
    parser = options_of.of_a_table("Compares meshes of raw views.", None, 900, "quality")
    parser.add_argument("--more-data", type=pathlib.Path, default=BENCH.parents[1] / "shared" / "data",
                        help="folder with 1-bunny and 5-raw (default: %(default)s)")
    options = parser.parse_args()
    if not (options.more_data / "5-raw" / "happy_stand").is_dir():
        print(f"skipped: no raw views in {options.more_data}", file=sys.stderr)
        return 0
    work = options.program.resolve().parents[2] / "peers" / "raw-views"
    load = machine.Load()
    records = [bunny(options.program, options.more_data, work / "bunny", options.limit),
               buddha(options.program, options.more_data, work / "buddha", options.limit)]
    results = {**page.described("make bench-quality"), "load": load.described(), "records": records}
    lines = lines_of(results)
    print("\n".join(lines))
    page.write(options.into, "raw-views", results, lines)
    failed = 0
    for record in records:
        for name, facts in record["surfaces"].items():
            if facts.get("outcome") == "ok" and misses(record["surfaces"], name):
                failed = 1
                print(f"error: {record['name']}, {name}: {', '.join(misses(record['surfaces'], name))}, but not doubtful",
                      file=sys.stderr)
    return failed


if __name__ == "__main__":
    sys.exit(main())
