#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""registration.py PROGRAM: registers views whose poses were thrown away by `register`, Open3D and PCL.

Every start turns and shifts all views at random; the poses that a program finds are compared with the known ones.
Cases: raw views (bunny, Buddha), virtual views of models, and single virtual views on the mesh of their model. Writes
registration.md and .json; the JSON keeps the results of cases that do not run (--only). The exit code is 1 if
`register` places a view wrongly, if a program fails, or if a bound of GOALS is missed. Raw views that the folder of
--more-data does not have are skipped, and PCL without its driver.
"""
import os

os.environ["OMP_NUM_THREADS"] = "1"  # read when open3d is imported

import json  # noqa: E402
import pathlib  # noqa: E402
import sys  # noqa: E402
import tempfile  # noqa: E402

import numpy  # noqa: E402

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

import registration_peers as peers  # noqa: E402
import registration_page  # noqa: E402
import registration_views as known  # noqa: E402
from harness import machine  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import page, scanmill  # noqa: E402
from tables.ply import write_ply  # noqa: E402

QUALITY = BENCH / "quality"
OURS = registration_page.OURS
#: Folders of the raw views below --more-data, and the largest right error in spacings. The Buddha's published poses are
#: themselves wrong by more than a spacing.
RAW = {"bunny": ("1-bunny/raw/bun.conf", 0.6), "buddha": ("5-raw/happy_stand/happyStandRight.conf", 2.0)}
VIRTUAL = ("fandisk_large", "anchor_dense", "couplingdown", "armadillo", "elephant")
VIRTUAL_BOUND = 0.2
TARGETS = ("fandisk_large", "anchor_dense", "couplingdown", "bunny00", "armadillo", "elephant")
TARGET_BOUND = 0.5
#: Larger errors than this, in voxels, are not an inexact pose but another one.
ROUGH = 2.0
#: Least shared part of pairs that a program should find.
OVERLAP = 0.15
#: Least share of a view's points on the target that counts as a fit; `register` asks the same.
LEAST_FIT = 0.8
#: A pose that fits like the known one: mean distance of the points from the model, as a ratio.
EQUAL = 1.05
#: Least number of placed views in every start.
GOALS = {"bunny": 10, "buddha": 14, "views-fandisk_large": 8}


def register(program, views, folder, limit):
    """Poses by view, accepted pairs with their poses, processor seconds, and the reasons of refused views by name."""
    files = known.write(views, folder)
    report = scanmill.run(program, QUALITY / "registration.yaml", files, folder / "out", limit, threads=1)
    cell = report["cells"][0]
    seconds = scanmill.steps(report, cell)["register"].get("cpu-seconds", 0.0)
    outputs = [one["file"] for one in cell.get("outputs", []) if one["outcome"] == "ok"]
    if not outputs:
        return {}, {}, seconds, {name: message_of(cell) for name in views.names}
    document = json.loads(pathlib.Path(outputs[0]).read_text())
    poses, refused = {}, {}
    for each in document["poses"]:
        if each.get("matrix") is None:
            refused[each["scan"]] = each["refused"]
        else:
            poses[views.names.index(each["scan"])] = numpy.array(each["matrix"])
    pairs = {tuple(views.names.index(name) for name in edge["views"]): numpy.array(edge["matrix"])
             for edge in document["edges"]}
    return poses, pairs, seconds, refused


def message_of(cell):
    error = cell.get("error", cell["outcome"])
    return (error["message"] if isinstance(error, dict) else error).splitlines()[0]


def counted(poses, views, bound):
    """Numbers of views. `near` ones are beyond the bound but not elsewhere; `errors` are by view, in spacings."""
    errors = known.errors_of(poses, views, bound) if poses else {}
    rough = known.errors_of(poses, views, ROUGH * views.voxel / views.spacing) if poses else {}
    right = sum(error <= bound for error in errors.values())
    near = max(0, sum(error <= ROUGH * views.voxel / views.spacing for error in rough.values()) - right)
    return {"right": right, "near": near, "wrong": len(poses) - right - near, "refused": len(views.names) - len(poses),
            "errors": {views.names[i]: round(error, 4) for i, error in errors.items()}}


def is_right(pair, pose, views):
    i, j = pair
    truth = numpy.linalg.inv(views.poses[j]) @ views.poses[i]
    return known.displacement(pose, truth, views.points[i][::20]) < ROUGH * views.voxel


def placed_pairs(poses, views, wanted):
    """The number of pairs whose views are placed right relative to each other."""
    return sum(i in poses and j in poses and is_right((i, j), numpy.linalg.inv(poses[j]) @ poses[i], views)
               for i, j in wanted)


def start_of(name, poses, pairs, accepted, seconds, views, bound, wanted, seed):
    right = {pair: is_right(pair, pose, views) for pair, pose in pairs.items()}
    placed = placed_pairs(poses, views, wanted)
    wanted = {frozenset(pair) for pair in wanted}
    return {"program": name, "seed": seed, **counted(poses, views, bound), "seconds": round(seconds, 3),
            "pairs": len(wanted), "pairs-placed": placed,
            "pairs-right": sum(right[pair] for pair in right if frozenset(pair) in wanted),
            "accepted": len(accepted), "accepted-wrong": sum(not right[pair] for pair in accepted)}


def views_starts(record, views, runs, options, makers, folder):
    """Adds the facts of a case to its record, and yields the results of starts; `runs` are programs and seeds."""
    wanted = known.overlapping(views, OVERLAP)
    record.update({"views": len(views.names), "spacing": views.spacing, "voxel": views.voxel,
                   "points": sum(map(len, views.points))})
    for name, seed in runs:
        turned = known.turned(views, seed)
        if name == OURS:
            poses, pairs, seconds, refused = register(options.program, turned, folder / "ours", options.limit)
            accepted, more = pairs, {"reasons": refused}
        else:
            peer = makers[name]()
            poses, pairs, accepted, seconds, second = peers.register(peer, turned, seed)
            peer.close()
            more = {"second-round": round(second, 3)}
        yield {**start_of(name, poses, pairs, accepted, seconds, turned, record["bound"], wanted, seed), **more}


def samples_of(mesh, spacing, seed=1):
    """Points at the density of the views, and the normals of their triangles."""
    import trimesh

    points, triangles = trimesh.sample.sample_surface(mesh, int(mesh.area / spacing**2), seed=seed)
    return numpy.asarray(points), numpy.asarray(mesh.face_normals[triangles])


def mean_distance(mesh, points):
    import open3d

    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(numpy.asarray(mesh.vertices, "f4"), numpy.asarray(mesh.faces, "u4"))
    return float(scene.compute_distance(points.astype("f4")).numpy().mean())


def judged_on_target(pose, views, mesh):
    """Whether the view is right, near, equal (elsewhere, but as near to the surface) or wrong; its error."""
    if pose is None:
        return {"outcome": "refused"}
    error = known.displacement(pose, views.poses[0], views.points[0])
    outcome = "right" if error <= TARGET_BOUND * views.spacing else "near" if error <= ROUGH * views.voxel else "wrong"
    if outcome == "wrong":
        distances = [mean_distance(mesh, known.moved(one, views.points[0])) for one in (pose, views.poses[0])]
        if distances[0] <= EQUAL * distances[1]:
            outcome = "equal"
    return {"outcome": outcome, "error": round(error / views.spacing, 4)}


def place(program, views, nominal, folder, limit):
    """The pose or None, processor seconds, and the reason of a refusal."""
    file = known.write(views, folder)[0]
    report = scanmill.run(program, QUALITY / "registration-target.yaml", [file], folder / "out", limit, threads=1,
                          inputs={"nominal": nominal})
    cell = report["cells"][0]
    seconds = scanmill.steps(report, cell)["register"].get("cpu-seconds", 0.0)
    outputs = [one["file"] for one in cell.get("outputs", []) if one["outcome"] == "ok"]
    if not outputs:
        return None, seconds, message_of(cell)
    document = json.loads(pathlib.Path(outputs[0]).read_text())
    return numpy.array(document["matrix"] if "matrix" in document else document["poses"][0]["matrix"]), seconds, ""


def target_starts(record, model, runs, options, makers, folder):
    """As views_starts(), with another view in every start."""
    import trimesh

    mesh = trimesh.load(model, process=False)
    views = known.of_model(options.program, model, folder / "scan", options.limit)
    record.update({"spacing": views.spacing, "voxel": views.voxel})
    nominal = folder / "nominal.ply"
    write_ply(nominal, mesh.vertices, mesh.faces)
    target = samples_of(mesh, views.spacing)
    for name, seed in runs:
        turned = known.turned(views.one((seed - 1) % len(views.names)), seed)
        if name == OURS:
            pose, seconds, reason = place(options.program, turned, nominal, folder / "ours", options.limit)
            more = {"reason": reason}
        else:
            peer = makers[name]()
            pose, fit, seconds = peers.place(peer, turned, target, seed)
            peer.close()
            more = {"fit": round(fit, 4)}
            pose = pose if fit >= LEAST_FIT else None
        yield {"program": name, "seed": seed, "view": turned.names[0], **judged_on_target(pose, turned, mesh),
               "seconds": round(seconds, 3), **more}


def tell(case, start):
    words = {name: value for name, value in start.items() if name not in ("program", "errors", "reasons", "reason")}
    if start.get("errors"):
        words["worst"] = max(start["errors"].values())
    print(f"{case}, {start['program']}:", *(f"{name} {value}" for name, value in words.items()),
          start.get("reason", ""), *(f"; {name}: {reason}" for name, reason in start.get("reasons", {}).items()),
          file=sys.stderr, flush=True)


def cases_of(options):
    """By name, new records and the functions that add starts to them."""
    def virtual(model):
        return lambda record, runs, makers, folder: views_starts(
            record, known.of_model(options.program, model, folder / "scan", options.limit), runs, options, makers,
            folder)

    def raw(conf):
        return lambda record, runs, makers, folder: views_starts(record, known.of_conf(conf), runs, options, makers,
                                                                 folder)

    def target(model):
        return lambda record, runs, makers, folder: target_starts(record, model, runs, options, makers, folder)

    found = {}
    for case, (conf, bound) in RAW.items():
        if (options.more_data / conf).is_file():
            found[case] = {"case": case, "kind": "views", "bound": bound}, raw(options.more_data / conf)
        else:
            print(f"skipped: {case}: no {options.more_data / conf}", file=sys.stderr)
    for kind, models, bound, make in (("views", VIRTUAL, VIRTUAL_BOUND, virtual),
                                      ("target", TARGETS, TARGET_BOUND, target)):
        for name in models:
            case = f"{kind}-{name}"
            found[case] = {"case": case, "kind": kind, "bound": bound}, make(options.data / "meshes" / f"{name}.off")
    return found


def runs_of(record, options, makers):
    """Programs and seeds that the record does not have yet."""
    if record["kind"] == "target":
        counts = {OURS: options.target_starts, **dict.fromkeys(makers, options.peer_target_starts)}
    else:
        counts = {OURS: options.starts, **dict.fromkeys(makers, options.peer_starts)}
        if "PCL" in makers:
            counts["PCL"] = options.pcl_starts
    done = {(start["program"], start["seed"]) for start in record["starts"]}
    return [(name, seed) for seed in range(1, max(counts.values()) + 1) for name, count in counts.items()
            if seed <= count and (name, seed) not in done]


def failures_of(record):
    """Sentences about views that we placed wrongly, and missed goals."""
    found = []
    for start in record["starts"]:
        if start["program"] != OURS:
            continue
        where = f"{record['case']}, seed {start['seed']}"
        if start.get("outcome") in ("near", "wrong", "equal"):
            found.append(f"{where}: {start['view']} is placed {start['outcome']}, {start['error']} spacings off")
        if record["kind"] == "views":
            beyond = {name: error for name, error in start["errors"].items() if error > record["bound"]}
            if beyond:
                found.append(f"{where}: beyond {record['bound']} spacings: "
                             + ", ".join(f"{name} {error}" for name, error in beyond.items()))
            if start["right"] < GOALS.get(record["case"], 0):
                found.append(f"{where}: {start['right']} views placed instead of {GOALS[record['case']]}")
    return found


def command_of(parser, options):
    """The command that makes the page anew, whatever runs the results were added by."""
    counts = ("starts", "peer_starts", "pcl_starts", "target_starts", "peer_target_starts")
    program = "/".join(options.program.resolve().parts[-4:])  # build/PRESET/bin/scanmill
    words = [f"--{name.replace('_', '-')} {getattr(options, name)}" for name in counts
             if getattr(options, name) != parser.get_default(name)]
    return " ".join([f"bench/quality/registration.py {program}", *words])


def main():
    parser = options_of.of_a_table("Compares registrations of views without poses.", None, 900, "quality")
    parser.add_argument("--more-data", type=pathlib.Path, default=BENCH.parents[1] / "shared" / "data",
                        help="folder with 1-bunny and 5-raw (default: %(default)s)")
    parser.add_argument("--only", help="names of cases or their beginnings, separated by commas")
    for name, count, what in (("--starts", 20, "of Scanmill, for views"), ("--peer-starts", 2, "of Open3D, for views"),
                              ("--pcl-starts", 1, "of PCL, for views"),
                              ("--target-starts", 10, "of Scanmill, on a target"),
                              ("--peer-target-starts", 5, "of the others, on a target")):
        parser.add_argument(name, type=int, default=count, help=f"starts {what} (default: %(default)s)")
    parser.add_argument("--add", action="store_true",
                        help="keep the starts that the JSON has, and run the missing ones")
    parser.add_argument("--pcl", type=pathlib.Path,
                        help="the driver of PCL (default: peer_pcl_registration beside the program)")
    options = parser.parse_args()
    driver = (options.pcl or options.program.parent / "peer_pcl_registration").resolve()
    every = cases_of(options)
    chosen = [case for case in every
              if not options.only or any(case.startswith(name) for name in options.only.split(","))]
    kept = options.into / "registration.json"
    records = {one["case"]: one for one in json.loads(kept.read_text())["records"]} if kept.is_file() else {}
    failed = []

    def save():
        order = [*(case for case in every if case in records), *(case for case in records if case not in every)]
        results = {**page.described(command_of(parser, options)), "records": [records[case] for case in order]}
        lines = registration_page.lines_of(results)
        page.write(options.into, "registration", results, lines)
        return lines

    for case in chosen:
        record, add = every[case]
        record = {**record, "starts": [], "runs": []}
        if options.add and case in records:
            record = records[case]
        load = machine.Load()
        with tempfile.TemporaryDirectory() as folder:
            makers = peers.makers(driver, pathlib.Path(folder))
            if "PCL" not in makers:
                print(f"skipped: PCL: no {driver}", file=sys.stderr)
            runs = runs_of(record, options, makers)
            described = page.described("")
            run = {name: described[name] for name in ("date", "revision")}
            if runs:
                record["runs"].append(run)
            try:
                for start in add(record, runs, makers, pathlib.Path(folder)) if runs else ():
                    tell(case, start)
                    record["starts"].append(start)
                    run["load"] = load.described()
                    records[case] = record
                    save()
            except (scanmill.Broken, RuntimeError) as failure:
                failed.append(f"{case}: {failure}")
        failed += failures_of(record)
    print("\n".join(save()))
    for failure in failed:
        print(f"error: {failure}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
