# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the program and reads its JSON. Computes no numbers."""
import json
import subprocess


class Broken(Exception):
    """The program gave no usable report. One sentence."""


def run(program, workflow, scans, folder, limit, threads=0, jobs=1, inputs=None, settings=None, until=None, unit=None):
    """The report of `scanmill run --json` without a cache. `inputs` are files and `settings` parameter values, by name.
    The run ends after the step `until`. Files without a unit have the unit `unit`. The report includes failed scans.
    Raises Broken without a report: bad arguments, a fault of the program, or no end within `limit` seconds."""
    command = [program, "run", workflow, *scans, "-o", folder, "--threads", threads, "--jobs", jobs]
    command += ["--no-cache", "--quiet", "--json"]
    if until:
        command += ["--until", until]
    if unit:
        command += ["--unit", unit]
    for name, file in (inputs or {}).items():
        command += ["--in", f"{name}={file}"]
    for name, value in (settings or {}).items():
        command += ["--set", f"{name}={value}"]
    return report([str(word) for word in command], limit)


def info(program, file, limit=60):
    """The output of `scanmill info --json` for one file."""
    return report([str(program), "info", str(file), "--json"], limit)["files"][0]


def measure(program, mesh, truth, limit, settings=(), threads=0, truth_unit=None):
    """The metrics of `scanmill measure --json`."""
    command = [str(program), "measure", str(mesh), str(truth), "--json", "--threads", str(threads)]
    for setting in settings:
        command += ["--set", setting]
    if truth_unit:
        command += ["--truth-unit", truth_unit]
    return report(command, limit)["metrics"]


def report(command, limit):
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=limit)
    except OSError as error:
        raise Broken(f"{command[0]} cannot be started: {error.strerror}") from None
    except subprocess.TimeoutExpired:
        raise Broken(f"{' '.join(command[:2])} … did not end within {limit:g} s") from None
    words = (done.stderr.strip().splitlines() or ["nothing on standard error"])[0]
    # 1: some scans failed; the report contains them.
    if done.returncode not in (0, 1):
        raise Broken(f"{' '.join(command[:2])} … ended with {done.returncode}: {words}")
    try:
        return json.loads(done.stdout)
    except ValueError:
        raise Broken(f"{' '.join(command[:2])} … printed no JSON: {words}") from None


def steps(report, cell):
    """A cell's steps by filter name. The step that reads the scan is "read". If a filter has several steps, the first
    one counts."""
    found = {}
    for number in cell["steps"]:
        step = report["steps"][number]
        found.setdefault(step.get("filter", "read"), step)
    return found


def named(report, cell):
    """A cell's steps by their names in the workflow."""
    return {report["steps"][number]["step"]: report["steps"][number] for number in cell["steps"]}


def mesh(cell):
    """The mesh among the outputs of a cell. Raises Broken unless there is exactly one."""
    meshes = [output for output in cell["outputs"] if output["kind"] == "mesh" and output["outcome"] == "ok"]
    if len(meshes) != 1:
        raise Broken(f"{cell['scan']}: the workflow wrote {len(meshes)} meshes instead of one")
    return meshes[0]


def features(cell):
    """The features that the cell wrote as JSON. Raises Broken if there are none."""
    for output in cell["outputs"]:
        if output["kind"] == "features" and output["outcome"] == "ok" and output["file"].endswith(".json"):
            with open(output["file"]) as file:
                return json.load(file)
    raise Broken(f"{cell['scan']}: the workflow wrote no features as JSON")
