#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""decimate.py BUILD: compares the number of triangles that programs need for the same distance from a mesh.

`decimate` gets a largest error. One judge (decimate_judge.py) measures the distance of its result from the input in
both directions. For every other program, a search (fewest.py) finds the fewest triangles with which the judge measures
at most the same distance. Evaluations of other programs are kept in build/peers/decimate and are not repeated, so a run
that was stopped continues. Writes decimate.md and .json. The exit code is 1 if `decimate` failed, exceeded its error or
added self-intersections, or if a file is missing.
"""
import argparse
import collections
import concurrent.futures
import hashlib
import json
import os
import pathlib
import shutil
import sys

import numpy

BENCH = pathlib.Path(__file__).resolve().parents[1]
ROOT = BENCH.parent
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

import decimate_page  # noqa: E402
import programs  # noqa: E402
from decimate_judge import Judge  # noqa: E402
from fewest import fewest  # noqa: E402
from harness import machine  # noqa: E402
from harness.inputs import Inputs, Missing  # noqa: E402
from harness.process import Failure, Process  # noqa: E402
from rows.decimate import others  # noqa: E402
from tables import options as options_of  # noqa: E402
from tables import page, scanmill  # noqa: E402
from tables.ply import write_ply  # noqa: E402

#: Largest errors, in percent of the diagonal.
SHARES = (1, 0.3, 0.1, 0.03)
#: Distances up to this share of the diagonal count as equal, because programs round coordinates to float.
ROUNDING = 1e-6
#: Kept evaluations of another version are repeated. Increase it with a change of the judge.
VERSION = 1

#: kind: scanned, organic or mechanical. solid: the file holds points, and the mesh is solid-of-scan.yaml's.
Model = collections.namedtuple("Model", "name file kind solid large", defaults=[False, False])
MODELS = [
    Model("bunny", "meshes/bunny00.off", "scanned"),
    Model("armadillo", "meshes/armadillo.off", "scanned"),
    Model("ball", "points_3/ball.ply", "scanned", solid=True),
    Model("kitten", "points_3/kitten.xyz", "scanned", solid=True),
    Model("dragon", "dragon/dragon_vrip.ply", "scanned", large=True),
    Model("lion-head", "meshes/lion-head.off", "organic"),
    Model("hand", "meshes/hand.off", "organic"),
    Model("camel", "meshes/camel.off", "organic"),
    Model("fandisk", "meshes/fandisk_large.off", "mechanical"),
    Model("anchor", "meshes/anchor_dense.off", "mechanical"),
]


def arguments():
    parser = argparse.ArgumentParser(description="Compares decimation at equal distance.")
    parser.add_argument("build", type=pathlib.Path, help="a build folder of the preset bench")
    parser.add_argument("--models", default="", help="names, separated by commas (default: all)")
    parser.add_argument("--large", action="store_true", help="also the dragon, which takes most of an hour")
    parser.add_argument("--data", type=pathlib.Path, default=ROOT / "build" / "data",
                        help="the folder that `make data` fills")
    parser.add_argument("--jobs", type=options_of.at_least_one, default=len(os.sched_getaffinity(0)),
                        help="programs that run at once (default: %(default)s)")
    parser.add_argument("--fresh", action="store_true", help="repeat kept evaluations")
    options_of.limit(parser, 900, "one decimation or measurement")
    parser.add_argument("--into", type=pathlib.Path,
                        help="folder of the results (default: bench/quality for all models, else build/peers/decimate)")
    return parser.parse_args()


def chosen(options):
    """The models to run. Exits if there is no model of a name."""
    models = [model for model in MODELS if options.large or not model.large]
    words = [word for word in options.models.split(",") if word]
    for word in words:
        if word not in [model.name for model in models]:
            sys.exit(f"error: there is no model '{word}'; the models are {', '.join(model.name for model in models)}")
    return [model for model in models if not words or model.name in words]


class Bench:
    """What the functions below share."""

    def __init__(self, options):
        self.options = options
        self.program = options.build / "bin" / "scanmill"
        self.work = options.build.resolve().parent / "peers" / "decimate"
        if options.fresh:
            shutil.rmtree(self.work, ignore_errors=True)
        self.inputs = Inputs(options.data, self.work.parent / "inputs", options.build / "bin" / "peer_inputs")
        threads = max(1, len(os.sched_getaffinity(0)) // options.jobs)
        self.judge = Judge(self.program, threads, options.limit)
        self.versions = {}

    def command(self, contender):
        return programs.command(contender.program, self.options.build)


def input_of(bench, model):
    """The arrays that the programs load. Raises Missing."""
    file = bench.options.data / model.file
    if model.solid and file.exists():
        made = bench.work / model.name / (pathlib.Path(model.file).stem + ".ply")
        if not made.exists():
            scanmill.run(bench.program, BENCH / "quality" / "solid-of-scan.yaml", [file], made.parent,
                         bench.options.limit)
        file = made.resolve()
    given = bench.inputs.scan(model.name, file)
    given.make()
    return given


def write_truth(given, path):
    """Writes the mesh that all programs decimate, for `decimate` and the judge. Returns the diagonal of its used
    points, and a hash of its arrays."""
    arrays = [given.path.with_suffix(suffix).read_bytes() for suffix in (".points", ".triangles")]
    points, triangles = numpy.frombuffer(arrays[0]).reshape(-1, 3), numpy.frombuffer(arrays[1], "u4").reshape(-1, 3)
    write_ply(path, points, triangles)
    used = points[numpy.unique(triangles)]
    return float(numpy.linalg.norm(used.max(axis=0) - used.min(axis=0))), hashlib.sha256(b"|".join(arrays)).hexdigest()


def broken_promise(facts, before, share, diagonal):
    """What our result must not be, as a sentence; empty if it is right. `before`: the facts of the input."""
    if facts["lower"] > share / 100 * diagonal:
        return f"its distance is at least {100 * facts['lower'] / diagonal:.4g} % of the diagonal"
    if facts["self_intersections"] > before["self_intersections"]:
        return f"self-intersections: {facts['self_intersections']:,}, in the input {before['self_intersections']:,}"
    return ""


def ours(bench, truth, before, share, diagonal):
    """Our result at a largest error of `share` percent of the diagonal."""
    report = scanmill.run(bench.program, BENCH / "quality" / "decimate.yaml", [truth], truth.parent / f"ours-{share}",
                          bench.options.limit, settings={"max-error": f"{share} %diag"})
    cell = report["cells"][0]
    if cell["outcome"] not in ("ok", "doubtful"):
        return {"failure": cell.get("error", cell["outcome"])}
    facts = bench.judge(scanmill.mesh(cell)["file"], truth)
    facts["seconds"] = scanmill.steps(report, cell)["decimate"]["seconds"]
    broken = broken_promise(facts, before, share, diagonal)
    return {**facts, "failure": broken} if broken else facts


class Peer:
    """Another program on one model. Its evaluations are kept in a file, by the number of triangles asked for."""

    def __init__(self, bench, contender, truth, hash_of_input):
        self.bench, self.contender, self.truth = bench, contender, truth
        self.base = truth.parent / contender.name.replace(" ", "-")
        self.process = None
        self.known = {}
        self.process = self._started()
        versions = self.process.ask({"do": "versions"}, bench.options.limit)
        bench.versions.update(versions)
        self.key = json.dumps([VERSION, hash_of_input, versions, contender.work], sort_keys=True)
        kept = self._file()
        if kept.exists():
            content = json.loads(kept.read_text())
            if content["key"] == self.key:
                self.known = {int(target): one for target, one in content["evaluations"].items()}

    def _file(self):
        return pathlib.Path(f"{self.base}.json")

    def _started(self):
        process = Process(self.bench.command(self.contender))
        process.ask(self.contender.prepare, self.bench.options.limit)
        return process

    def evaluate(self, target):
        """The judged result with that many triangles. Failures are recorded too."""
        try:
            evaluation = self._evaluated(target)
        except (Failure, scanmill.Broken) as failure:
            evaluation = {"failure": str(failure)}
            self.close()
        self.known[target] = evaluation
        content = {"key": self.key, "evaluations": {str(one): self.known[one] for one in sorted(self.known)}}
        part = pathlib.Path(f"{self.base}.part")
        part.write_text(json.dumps(content, indent=1))
        part.replace(self._file())
        return evaluation

    def _evaluated(self, target):
        if not self.process:
            self.process = self._started()
        request = {**self.contender.work, "triangles": target, "into": str(self.base)}
        answer = self.process.time(request, self.bench.options.limit)
        points, triangles = numpy.fromfile(f"{self.base}.points"), numpy.fromfile(f"{self.base}.triangles", "u4")
        mesh = pathlib.Path(f"{self.base}.ply")
        write_ply(mesh, points.reshape(-1, 3), triangles.reshape(-1, 3))
        return {**self.bench.judge(mesh, self.truth), "seconds": answer["seconds"]}

    def close(self):
        if self.process:
            self.process.close()
        self.process = None


def searched(bench, contender, truth, hash_of_input, total, goals):
    """The results of a program for every goal: a distance, and the first number of triangles to try."""
    found, peer = [], None
    try:
        peer = Peer(bench, contender, truth, hash_of_input)
        for distance, guess in goals:
            best, made = fewest(peer.evaluate, peer.known, distance, total, guess)
            failures = [one["failure"] for one in peer.known.values() if "failure" in one]
            found.append({**(best or {"failure": (failures or ["too far at every number"])[-1]}), "evaluations": made})
    except Failure as failure:
        found += [{"failure": str(failure), "evaluations": 0}] * (len(goals) - len(found))
    finally:
        if peer:
            peer.close()
    return found


def run(bench, model):
    """The record of a model."""
    record = {"name": model.name, "file": model.file, "kind": model.kind, "failure": "", "distances": []}
    folder = bench.work / model.name
    folder.mkdir(parents=True, exist_ok=True)
    try:
        given = input_of(bench, model)
        truth = folder / "input.ply"
        diagonal, hash_of_input = write_truth(given, truth)
        record.update(diagonal=diagonal, input=bench.judge.alone(truth))
        results = [ours(bench, truth, record["input"], share, diagonal) for share in SHARES]
    except (Missing, scanmill.Broken) as failure:
        return {**record, "failure": str(failure)}
    record["distances"] = [{"share": share, "ours": result, "others": {}} for share, result in zip(SHARES, results)]
    measured = [one for one in record["distances"] if "upper" in one["ours"]]
    goals = [(max(one["ours"]["upper"], ROUNDING * diagonal), one["ours"]["triangles"]) for one in measured]
    contenders = others(given)
    with concurrent.futures.ThreadPoolExecutor(bench.options.jobs) as pool:
        search = lambda contender: searched(bench, contender, truth, hash_of_input, record["input"]["triangles"],
                                            goals)
        for contender, found in zip(contenders, pool.map(search, contenders)):
            for one, result in zip(measured, found):
                one["others"][contender.name] = result
    return record


def failures(records):
    """Our failures, as sentences."""
    for record in records:
        if record["failure"]:
            yield f"{record['name']}: {record['failure']}"
        for one in record["distances"]:
            if "failure" in one["ours"]:
                yield f"{record['name']} at {one['share']} %: {one['ours']['failure']}"


def main():
    options = arguments()
    models = chosen(options)
    bench = Bench(options)
    load = machine.Load()
    records = []
    for model in models:
        records.append(run(bench, model))
        print("\n".join(decimate_page.of_model(records[-1])), flush=True)
    whole = len(models) == len([model for model in MODELS if options.large or not model.large])
    results = {**page.described("make bench-quality" + (" LARGE=1" if options.large else "")),
               "versions": bench.versions, "load": load.described(), "models": records}
    lines = decimate_page.lines(results)
    print("\n".join(lines))
    page.write(options.into or (BENCH / "quality" if whole else bench.work), "decimate", results, lines)
    failed = list(failures(records))
    for failure in failed:
        print(f"error: {failure}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
