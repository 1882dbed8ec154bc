#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures a batch of many small scans on one machine and on 1, 2 and 4 nodes of a Slurm that this machine simulates.

Every case is a new process with an empty cache. The cases run in turn, A B C A B C, so that other load affects all. A node has one
core: its jobs are bound to it. Four nodes share two cores, which tests the result only. Needs root, as Slurm does; without Slurm only
the cases of one machine run."""
import argparse
import dataclasses
import json
import os
import pathlib
import shutil
import sqlite3
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "peers"))
sys.path.insert(0, str(HERE))
from harness import machine  # noqa: E402
from scans import write_batch  # noqa: E402


@dataclasses.dataclass
class Case:
    name: str
    batch: str
    nodes: int = 0  # 0: no Slurm
    jobs: int = 1
    rounds: int | None = None  # None: all


@dataclasses.dataclass
class Measured:
    seconds: float  # from the start, or the submission, to the end of the last cell
    step_seconds: float  # sum over the steps that ran
    step_cpu: float
    cells: int
    program: float = 0  # sum over the chunks: seconds of the program, on one core each
    last_ends: float = 0  # sum over the nodes: seconds that a node waits for the last chunk of all
    chunks: int = 0
    merge: float = 0
    report: float = 0


def run(command, **more):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)
    if done.returncode:
        raise SystemExit(f"error: {' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def recorded(folder):
    """Seconds and CPU seconds of the steps of the last run, and its cells."""
    with sqlite3.connect(f"file:{folder}/scanmill.sqlite?mode=ro", uri=True) as records:
        last = records.execute("select max(id) from run").fetchone()[0]
        steps = records.execute("select sum(seconds), sum(cpu_seconds) from step where parent = ? and origin = 'ran'", (last,)).fetchone()
        return *steps, records.execute("select count(*) from cell where parent = ?", (last,)).fetchone()[0]


class Bench:
    def __init__(self, program, folder, scans_per_chunk):
        self.folder, self.scans_per_chunk = folder, scans_per_chunk
        (folder / "bin").mkdir()
        (folder / "bin/scanmill").symlink_to(program)
        self.environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}", "HOME": str(folder)}
        self.environment.pop("XDG_CACHE_HOME", None)

    def prepare(self, case):
        """An empty folder, which is also the home of an empty cache."""
        case_folder = self.folder / case.name.replace(" ", "-")
        shutil.rmtree(case_folder, ignore_errors=True)
        case_folder.mkdir()
        return case_folder, {**self.environment, "XDG_CACHE_HOME": str(case_folder / "cache"), "TIMES": str(case_folder / "times.txt")}

    def measure(self, case):
        return self.on_nodes(case) if case.nodes else self.on_machine(case)

    def on_machine(self, case):
        case_folder, environment = self.prepare(case)
        begin = time.monotonic()
        run(["taskset", "-c", f"0-{case.jobs - 1}", "scanmill", "batch", self.folder / f"{case.batch}.yaml", "-o", case_folder / "result", "-j",
             str(case.jobs), "-q"], env=environment)
        return Measured(time.monotonic() - begin, *recorded(case_folder / "result"))

    def on_nodes(self, case):
        case_folder, environment = self.prepare(case)
        # Without records a cell is estimated at one second. All cases have chunks of one size: weak scaling needs equal work per node.
        run(["scanmill", "export", "slurm", self.folder / f"{case.batch}.yaml", "-o", case_folder / "cluster", "--minutes",
             str(2 * self.scans_per_chunk / 60), "--program", HERE / "on_core.sh"], env=environment)
        chunks = len(list((case_folder / "cluster/chunks").iterdir()))
        begin, clock = time.monotonic(), time.time()
        run(["sbatch", "run.sbatch"], cwd=case_folder / "cluster", env={**environment, "SBATCH_PARTITION": f"first{case.nodes}"})
        times = case_folder / "times.txt"
        while not times.exists() or times.read_text().count("\n") < chunks:
            time.sleep(0.05)
            if time.monotonic() - begin > 600:
                raise SystemExit(f"error: {case.name}: no end after ten minutes; {case_folder}/cluster/logs")
        rows = [(node, float(first), float(last)) for node, first, last in map(str.split, times.read_text().splitlines())]
        ends = {}
        for node, _, last in rows:
            ends[node] = max(ends.get(node, 0), last)
        measured = Measured(max(ends.values()) - clock, 0, 0, 0, sum(last - first for _, first, last in rows),
                            sum(max(ends.values()) - end for end in ends.values()), chunks)
        begin = time.monotonic()
        run(["scanmill", "runs", "merge", *sorted((case_folder / "cluster/parts").iterdir()), "-o", case_folder / "result"], env=environment)
        measured.merge = time.monotonic() - begin
        begin = time.monotonic()
        run(["scanmill", "report", case_folder / "result"], env=environment)
        measured.report = time.monotonic() - begin
        measured.step_seconds, measured.step_cpu, measured.cells = recorded(case_folder / "result")
        while run(["squeue", "-h"]).strip():
            time.sleep(0.1)
        return measured

    def page(self, case):
        """Seconds of the report page of the last round, whose previews are all new."""
        case_folder = self.folder / case.name.replace(" ", "-")
        begin = time.monotonic()
        run(["scanmill", "report", case_folder / "result", "--html", case_folder / "page.html"], env=self.environment)
        return time.monotonic() - begin

    def differences(self, one, other):
        """The names of the meshes that differ between the results of two cases, or are in one only."""
        folders = [self.folder / case.name.replace(" ", "-") / "result" for case in (one, other)]
        names = {file.name for folder in folders for file in folder.glob("*.ply")}
        same = lambda name: all((folder / name).exists() for folder in folders) and \
            (folders[0] / name).read_bytes() == (folders[1] / name).read_bytes()  # noqa: E731
        return sorted(name for name in names if not same(name))


def busy_cores(seconds=3):
    """Cores in use while this process sleeps. Jobs of Slurm are not our children, so a bench with them cannot be subtracted."""
    ticks = []
    for _ in range(2):
        with open("/proc/stat", encoding="ascii") as file:
            ticks.append(machine.busy_and_stolen(file.readline())[0])
        if len(ticks) == 1:
            time.sleep(seconds)
    return (ticks[1] - ticks[0]) / os.sysconf("SC_CLK_TCK") / seconds


def spread(values, digits=1):
    return f"{statistics.median(values):.{digits}f} ({min(values):.{digits}f} to {max(values):.{digits}f})"


def table(cases, results):
    """One row per case: median, least and most over the rounds."""
    yield "| case | cells | seconds | cells per second | engine, ms per cell | scheduler, s per chunk | merge, s | report, s | undisturbed |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for case in cases:
        rounds = results[case.name]
        nodes = case.nodes or case.jobs
        engine = [1000 * ((m.program if case.nodes else m.seconds * nodes) - m.step_seconds) / m.cells for m in rounds]
        scheduler = [(m.seconds * nodes - m.last_ends - m.program) / m.chunks if case.nodes else 0 for m in rounds]
        only_result = case.nodes > 2
        yield (f"| {case.name} | {rounds[0].cells} | {spread([m.seconds for m in rounds])} | "
               f"{statistics.median(m.cells / m.seconds for m in rounds):.0f} | {'–' if only_result else spread(engine)} | "
               f"{spread(scheduler, 2) if case.nodes and not only_result else '–'} | "
               f"{spread([m.merge for m in rounds], 2) if case.nodes else '–'} | "
               f"{spread([m.report for m in rounds], 2) if case.nodes else '–'} | "
               f"{100 * statistics.median(m.step_cpu / m.step_seconds for m in rounds):.0f} % |")


def efficiencies(results):
    """Weak scaling: the work per node is constant. Names where the lost share of two nodes' time goes."""
    pairs = list(zip(results["1 node, half"], results["2 nodes"]))
    yield "| weak scaling | seconds | efficiency |"
    yield "|---|---|---|"
    yield f"| half of the scans on 1 node | {spread([half.seconds for half, _ in pairs])} | 1 |"
    yield f"| all scans on 2 nodes | {spread([both.seconds for _, both in pairs])} | {spread([half.seconds / both.seconds for half, both in pairs], 3)} |"
    yield ""
    loss = {
        "slower steps, as the nodes share caches, memory and disk of this machine":
            [(both.step_seconds - 2 * half.step_seconds) / (2 * both.seconds) for half, both in pairs],
        "slower work of the engine outside of steps (start, files, records), for the same reasons":
            [((both.program - both.step_seconds) - 2 * (half.program - half.step_seconds)) / (2 * both.seconds) for half, both in pairs],
        "uneven ends: a node waits for the last chunk": [both.last_ends / (2 * both.seconds) for _, both in pairs],
        "the scheduler": [((2 * both.seconds - both.last_ends - both.program) - 2 * (half.seconds - half.program)) / (2 * both.seconds)
                          for half, both in pairs],
    }
    yield "Share of the two nodes' time that is lost against one node, median:"
    yield ""
    for name, shares in sorted(loss.items(), key=lambda item: -statistics.median(item[1])):
        yield f"- {100 * statistics.median(shares):.1f} %: {name}"
    yield ""
    name, shares = max(loss.items(), key=lambda item: statistics.median(item[1]))
    yield f"The limit of the nodes: {name}." if statistics.median(shares) > 0.02 else "No share is above 2 %: the nodes scale."
    yield ""
    serial = statistics.median((both.merge + both.report) / both.cells for _, both in pairs)
    work = statistics.median(both.program / both.cells for _, both in pairs)
    yield (f"Merge and the report in text run on one machine and take {1000 * serial:.2f} ms per cell, a chunk {1000 * work:.1f} ms. With cells as small "
           f"as these, they take as long as the chunks on {work / serial:.0f} nodes of one core; with cells of a minute, on {60 / serial:,.0f}. "
           "The report page comes on top, with a time that is limited.")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--scans", type=int, default=1000)
    parser.add_argument("--points", type=int, default=1000, help="of a scan")
    parser.add_argument("--chunks", type=int, default=10, help="of all scans; even, for two nodes")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--into", type=pathlib.Path, default=HERE, help="folder of results.md and results.json")
    arguments = parser.parse_args()
    obstacle = run([HERE / "cluster.sh", "obstacle"]).strip()
    cases = [Case("batch -j 1", "all"), Case("batch -j 2", "all", jobs=2)]
    if obstacle:
        print(f"skipped: the cases with Slurm; this machine {obstacle}")
    else:
        cases += [Case("1 node", "all", 1), Case("2 nodes", "all", 2), Case("1 node, half", "half", 1), Case("4 nodes", "all", 4, rounds=1)]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        folder.chmod(0o755)
        bench = Bench(pathlib.Path(arguments.program).resolve(), folder, arguments.scans // arguments.chunks)
        write_batch(folder, "all", arguments.scans, arguments.points)
        write_batch(folder, "half", arguments.scans // 2, arguments.points)
        results = {case.name: [] for case in cases}
        others = [busy_cores()]
        try:
            if not obstacle:
                run([HERE / "cluster.sh", "start", folder])
            for number in range(arguments.rounds):
                for case in cases:
                    if case.rounds is None or number < case.rounds:
                        results[case.name].append(bench.measure(case))
                        print(f"round {number + 1}: {case.name}: {results[case.name][-1].seconds:.1f} s", flush=True)
            page = bench.page(cases[0])
            wrong = {case.name: bench.differences(cases[0], case) for case in cases if case.batch == "all"}
        finally:
            subprocess.run([HERE / "cluster.sh", "stop", folder], check=False)
        others.append(busy_cores())
        facts = {**machine.described(), "busy_cores": others, "scans": arguments.scans, "points": arguments.points,
                 "date": time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime()), "version": run([arguments.program, "--version"]).strip()}
    text = ["<!-- Written by `make bench-scale`. Do not edit. -->", "# Many machines, simulated on one", "",
            f"{facts['date']}, {facts['processor']}, {facts['cores']} cores, {facts['memory_gibibytes']} GiB. {facts['version']}. "
            f"{arguments.scans} scans of {arguments.points} points, two variants of each; {arguments.rounds} rounds, in turn. "
            "Median, with least and most.", "",
            *table(cases, results), "",
            "*engine*: time of the program outside of steps. *scheduler*: time of a node without a chunk, per chunk, without the wait for the "
            "last one. *undisturbed*: CPU time of the steps as a share of their time; less means that other processes took the cores. Four nodes "
            "share two cores, so only their result counts.", ""]
    if not obstacle:
        text += [*efficiencies(results), ""]
    text += [f"The first report page of the {results[cases[0].name][0].cells} cells took {page:.0f} s, most of it for the pictures of at most 1,000 cells.", ""]
    bad = {name: len(files) for name, files in wrong.items() if files}
    text += ["The meshes of all cases are equal, byte for byte." if not bad else f"Meshes that differ from those of `batch -j 1`: {bad}.", "",
             f"Other processes used {others[0]:.1f} cores before the first round and {others[1]:.1f} after the last."]
    print("\n" + "\n".join(text))
    arguments.into.mkdir(parents=True, exist_ok=True)
    (arguments.into / "results.md").write_text("\n".join(text) + "\n")
    (arguments.into / "results.json").write_text(json.dumps(
        {"machine": facts, "page": page, "cases": {name: [dataclasses.asdict(m) for m in rounds] for name, rounds in results.items()}}, indent=1) + "\n")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
