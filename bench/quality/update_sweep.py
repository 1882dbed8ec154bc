#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""update_sweep.py PROGRAM: updates models by scans of a change in hundreds of seeded cases, and judges the results.

Every case has a model, a feature that is added to it or removed, and a scan of the change with a registration error and
noise (update_cases.py). The judge compares the updated mesh with the exact boolean of model and feature
(update_judge.py). Writes update-sweep.md and .json, with --rebuild local update-sweep-local.md and .json. The exit code
is 1 if a mesh is wrong in silence, or if the program gave no answer.

Cases, and the models that tight-cocone makes for them, are kept in build/peers/update-sweep until the scripts that make
them change. So every version of the program gets the same cases; after the folder is removed, they are made anew.
"""
from __future__ import annotations

import argparse
import hashlib
import multiprocessing
import pathlib
import pickle
import shutil
import sys
import tempfile

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "peers"), str(BENCH / "quality")]

import update_cases  # noqa: E402
import update_judge  # noqa: E402
import update_models  # noqa: E402
import update_sweep_page  # noqa: E402
from harness import machine  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import page, scanmill  # noqa: E402
from tables.ply import write_ply  # noqa: E402
from update_cases import Case, Model  # noqa: E402

WORKFLOW = BENCH / "quality" / "mesh-update.yaml"
KEPT = BENCH.parent / "build" / "peers" / "update-sweep"
SOURCES = ("update_solids.py", "update_cases.py")
SOURCES_OF_MODELS = ("update_solids.py", "update_models.py", "woo-dey-cloud.yaml")
SEED = 2005
METRICS = ("initial", "resampled", "added", "discarded", "kept", "unused-points", "groups", "replaced", "loops")


def arguments() -> argparse.Namespace:
    parser = options_of.of_a_table("Updates models by scans of a change, and judges the results.", None, 60, "quality")
    parser.add_argument("--more-data", type=pathlib.Path, default=BENCH.parents[1] / "shared" / "data",
                        help="folder of optional files (default: %(default)s)")
    parser.add_argument("--cases", type=options_of.at_least_one, default=200,
                        help="number of cases (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=SEED, help="of all cases (default: %(default)s)")
    parser.add_argument("--only", help="indices of cases, separated by commas; writes no page")
    parser.add_argument("--rebuild", choices=("whole", "local"), default="whole", help="the parameter of mesh-update")
    parser.add_argument("--keep", type=pathlib.Path, help="folder that keeps all files of the cases")
    parser.add_argument("--jobs", type=options_of.at_least_one, default=2,
                        help="cases at a time (default: %(default)s)")
    return parser.parse_args()


def hash_of(sources: tuple[str, ...]) -> hashlib._Hash:
    found = hashlib.sha256()
    for source in sources:
        found.update((BENCH / "quality" / source).read_bytes())
    return found


def models_of(options: argparse.Namespace, folder: pathlib.Path) -> tuple[dict[str, list[Model]], list[str]]:
    """The models by tight-cocone, and sentences about those that are missing; the kept ones if all files were there."""
    file = KEPT / f"models-{hash_of(SOURCES_OF_MODELS).hexdigest()[:16]}.pickle"
    if file.exists():
        return pickle.loads(file.read_bytes())
    found = update_models.made_by_tight_cocone(options, folder)
    if set(found[0]) == set(update_models.SCANNED):
        keep(file, found)
    return found


def keep(file: pathlib.Path, value: object) -> None:
    """Writes the file whole or not at all."""
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_suffix(".part")
    part.write_bytes(pickle.dumps(value))
    part.replace(file)


def digest(prebuilt: dict[str, list[Model]]) -> str:
    """Changes whenever the cases may change."""
    found = hash_of(SOURCES)
    for name, models in prebuilt.items():
        found.update(name.encode())
        for model in models:
            found.update(model.mesh.vertices.tobytes() + model.mesh.faces.tobytes())
    return found.hexdigest()[:16]


def case_of(options: argparse.Namespace, index: int, prebuilt: dict[str, list[Model]], cache: pathlib.Path) -> Case:
    file = cache / f"{options.seed}-{index}.pickle"
    if file.exists():
        return pickle.loads(file.read_bytes())
    case, _ = update_cases.case_of(options.seed, index, prebuilt)
    keep(file, case)
    return case


def outcome_of(case: Case, cell: dict, step: dict, allowed: list[str]) -> dict:
    """The outcome, its reason, and measured values."""
    if cell["outcome"] not in ("ok", "doubtful"):
        reason = str(cell.get("error", cell["outcome"])).partition("\n")[0]
        if cell.get("cause") != "refused":
            return {"outcome": "crashed", "reason": reason}
        right = any(word in reason for word in allowed)
        return {"outcome": "admissible" if right else "refused", "reason": reason}
    metrics = step["metrics"]
    result = update_judge.Result.load(pathlib.Path(scanmill.mesh(cell)["file"]))
    faults, values = update_judge.faults(case, result, int(metrics["resampled"]))
    if metrics["kept"] != metrics["initial"] + metrics["resampled"] - metrics["discarded"]:
        faults.append("the counts do not add up")
    doubts = [doubt.removeprefix("mesh-update: ") for doubt in cell.get("doubts", [])]
    name = ("wrong" if faults else "right") + (", doubtful" if cell["outcome"] == "doubtful" else "")
    return {"outcome": name, "reason": "; ".join([*faults, *doubts]), "values": values,
            "metrics": {name: int(metrics[name]) for name in METRICS if name in metrics},
            "seconds": step.get("seconds")}


def record_of(options: argparse.Namespace, index: int, prebuilt: dict[str, list[Model]], cache: pathlib.Path,
              work: pathlib.Path) -> dict:
    """One case: its facts and its outcome."""
    case = case_of(options, index, prebuilt, cache)
    allowed = update_judge.admissible(case, options.rebuild)
    folder = work / str(index)
    model = update_models.write(folder, "model.ply", case.model.mesh)
    write_ply(folder / "cloud.ply", case.cloud.points)
    record = {**case.facts(), "rim_offset": update_judge.rim_offset(case), "admissible": allowed}
    try:
        report = scanmill.run(options.program, WORKFLOW, [model], folder / "out", options.limit, threads=1, jobs=0,
                              inputs={"clouds": folder / "cloud.ply"}, settings={"rebuild": options.rebuild})
        cell = report["cells"][0]
        step = scanmill.steps(report, cell).get("mesh-update", {})
        record.update(outcome_of(case, cell, step, allowed))
    except scanmill.Broken as broken:
        record.update(outcome="crashed", reason=str(broken))
    if options.keep:
        update_models.write(folder, "truth.ply", case.truth)
        write_ply(folder / "clean.ply", case.cloud.clean)
    else:
        shutil.rmtree(folder)
    return record


def worker(numbers: multiprocessing.Queue, records: multiprocessing.Queue, options: argparse.Namespace,
           prebuilt: dict[str, list[Model]], cache: pathlib.Path, work: pathlib.Path) -> None:
    while (index := numbers.get()) is not None:
        try:
            records.put(record_of(options, index, prebuilt, cache, work))
        except Exception as error:  # a fault of this bench
            records.put({"index": index, "broken": f"{type(error).__name__}: {error}"})


def all_records(options: argparse.Namespace, indices: list[int], prebuilt: dict[str, list[Model]],
                cache: pathlib.Path, work: pathlib.Path) -> list[dict]:
    context = multiprocessing.get_context("spawn")
    numbers, records = context.Queue(), context.Queue()
    for index in indices:
        numbers.put(index)
    processes = [context.Process(target=worker, args=(numbers, records, options, prebuilt, cache, work))
                 for _ in range(min(options.jobs, len(indices)))]
    for process in processes:
        numbers.put(None)
        process.start()
    found = []
    for _ in indices:
        record = records.get()
        if "broken" in record:
            for process in processes:
                process.terminate()
            sys.exit(f"error: case {record['index']}: {record['broken']}")
        found.append(record)
        print(update_sweep_page.line_of(record), file=sys.stderr, flush=True)
    for process in processes:
        process.join()
    return sorted(found, key=lambda record: record["index"])


def main() -> int:
    options = arguments()
    load = machine.Load()
    name = "update-sweep" if options.rebuild == "whole" else f"update-sweep-{options.rebuild}"
    indices = [int(one) for one in options.only.split(",")] if options.only else list(range(options.cases))
    with tempfile.TemporaryDirectory() as temporary:
        work = options.keep or pathlib.Path(temporary)
        work.mkdir(parents=True, exist_ok=True)
        try:
            prebuilt, missing = models_of(options, pathlib.Path(temporary) / "models")
        except scanmill.Broken as broken:
            sys.exit(f"error: {broken}")
        cache = KEPT / digest(prebuilt)
        records = all_records(options, indices, prebuilt, cache, work)
    results = {**page.described("bench/quality/update_sweep.py"), "load": load.described(), "seed": options.seed,
               "rebuild": options.rebuild, "missing": missing, "cases": records}
    lines = update_sweep_page.lines_of(results, name)
    print("\n".join(lines))
    if not options.only:
        page.write(options.into, name, results, lines)
    return 1 if any(record["outcome"] in update_judge.FATAL for record in records) else 0


if __name__ == "__main__":
    sys.exit(main())
