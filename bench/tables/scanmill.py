# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a workflow and reads what the program says of it. No number is calculated here."""
import json
import subprocess


class Broken(Exception):
    """The program gave no report. One sentence."""


def run(program, workflow, scans, folder, limit, threads=0, jobs=1, inputs=None, settings=None):
    """The report of `scanmill run --json`; nothing comes from a cache. `inputs` and `settings` (of parameters) are by
    name. Scans that fail are in the report. Raises Broken when there is none: bad arguments, a fault of the program, or
    no end within `limit` seconds."""
    command = [program, "run", workflow, *scans, "-o", folder, "--threads", threads, "--jobs", jobs]
    command += ["--no-cache", "--quiet", "--json"]
    for name, file in (inputs or {}).items():
        command += ["--in", f"{name}={file}"]
    for name, value in (settings or {}).items():
        command += ["--set", f"{name}={value}"]
    return report([str(word) for word in command], limit)


def info(program, file, limit=60):
    """What `scanmill info --json` says of one file."""
    return report([str(program), "info", str(file), "--json"], limit)["files"][0]


def measure(program, mesh, truth, limit, settings=()):
    """The metrics of `scanmill measure --json`."""
    command = [str(program), "measure", str(mesh), str(truth), "--json"]
    for setting in settings:
        command += ["--set", setting]
    return report(command, limit)["metrics"]


def report(command, limit):
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=limit)
    except OSError as error:
        raise Broken(f"{command[0]} cannot be started: {error.strerror}") from None
    except subprocess.TimeoutExpired:
        raise Broken(f"{' '.join(command[:2])} … did not end within {limit:g} s") from None
    words = (done.stderr.strip().splitlines() or ["nothing on standard error"])[0]
    # 1: some scans failed, and the report says which.
    if done.returncode not in (0, 1):
        raise Broken(f"{' '.join(command[:2])} … ended with {done.returncode}: {words}")
    try:
        return json.loads(done.stdout)
    except ValueError:
        raise Broken(f"{' '.join(command[:2])} … printed no JSON: {words}") from None


def steps(report, cell):
    """A cell's steps by the names of their filters; reading the scan is called "read". Of several steps of one filter
    the first."""
    found = {}
    for number in cell["steps"]:
        step = report["steps"][number]
        found.setdefault(step.get("filter", "read"), step)
    return found


def named(report, cell):
    """A cell's steps by their names in the workflow."""
    return {report["steps"][number]["step"]: report["steps"][number] for number in cell["steps"]}


def mesh(cell):
    """The one mesh that the cell wrote, as told in its outputs. Raises Broken when there is none or several."""
    meshes = [output for output in cell["outputs"] if output["kind"] == "mesh" and output["outcome"] == "done"]
    if len(meshes) != 1:
        raise Broken(f"{cell['scan']}: the workflow wrote {len(meshes)} meshes, and one is to be judged")
    return meshes[0]


def features(cell):
    """The features that the cell wrote as JSON. Raises Broken when there are none."""
    for output in cell["outputs"]:
        if output["kind"] == "features" and output["outcome"] == "done" and output["file"].endswith(".json"):
            with open(output["file"]) as file:
                return json.load(file)
    raise Broken(f"{cell['scan']}: the workflow wrote no features as JSON")
