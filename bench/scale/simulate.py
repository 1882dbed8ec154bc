#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures how merge, report, records and export grow with the number of cells, and extends the lines to a million scans.

The program runs a batch of 100 tiny scans with two variants. Copies of its folder stand for the other chunks: their records get other
scans, chunk numbers and places, and their outputs are links to the same files. The program then merges and reports them as real ones."""
import argparse
import os
import pathlib
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from scans import write_batch  # noqa: E402

SCANS_PER_CHUNK = 100


def timed(command, **more):
    """Seconds and peak memory in bytes. Exit codes 0 and 4 are good."""
    begin = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, **more)
    error = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 4):
        raise SystemExit(f"error: {' '.join(map(str, command))}: exit code {process.returncode}\n{error[:2000]}")
    return time.monotonic() - begin, usage.ru_maxrss * 1024


def tree(folder):
    """Number and bytes of the files below a folder."""
    sizes = [file.stat().st_size for file in folder.rglob("*") if file.is_file()]
    return len(sizes), sum(sizes)


class Chunks:
    """Copies of the folder of one chunk."""

    def __init__(self, template):
        self.template = template

    def write(self, folder, count):
        outputs = [file for file in self.template.iterdir() if not file.name.startswith("scanmill.")]
        for number in range(1, count + 1):
            part = folder / f"{number:05}"
            part.mkdir(parents=True)
            for file in outputs:
                os.link(file, part / f"{number:05}-{file.name}")
            shutil.copy(self.template / "scanmill.sqlite", part)
            self._renumber(part, number, count)

    def _renumber(self, part, number, count):
        records = sqlite3.connect(part / "scanmill.sqlite", isolation_level=None)
        # A copy is written once and never read after a crash.
        records.executescript("pragma journal_mode = off; pragma synchronous = off; begin")
        records.execute("update run set shard = ?, folder = ?", (f"{number}/{count}", str(part)))
        for table, column in [("cell", "scan"), ("step", "scan")]:
            records.execute(f"update {table} set {column} = ? || {column} where {column} != ''", (f"{number:05}-",))
        cells = records.execute("select count(*) from cell").fetchone()[0]
        records.execute("update cell set place = place + ?", ((number - 1) * cells,))
        prefix = f"{self.template}/"
        records.execute("update cell_outputs set file = ? || substr(file, ?)", (f"{part}/{number:05}-", len(prefix) + 1))
        records.execute("commit")
        records.close()


def measure(program, folder, scans, template, environment, with_page):
    """One row of the table: a batch of so many scans."""
    row = {"scans": scans, "cells": 2 * scans}
    batch_folder = folder / f"of-{scans}"
    # Export and one chunk read the names of all scans.
    batch = batch_folder / "all.yaml"
    (batch_folder / "all").mkdir(parents=True)
    source = sorted((folder / "chunk").iterdir())
    for number in range(scans):
        os.link(source[number % len(source)], batch_folder / "all" / f"{number:07}.ply")
    shutil.copy(folder / "mesh.yaml", batch_folder)
    batch.write_text((folder / "chunk.yaml").read_text().replace("chunk", "all"))
    row["export"], row["export memory"] = timed([program, "export", "slurm", batch, "-o", batch_folder / "cluster", "--minutes",
                                                 str(2 * SCANS_PER_CHUNK / 60)], env=environment)
    # The second time, every step is in the cache: what remains is the start, the names of all scans, and the records.
    timed([program, "batch", batch, "--cells", batch_folder / "cluster/chunks/0001.json", "-o", batch_folder / "first", "-q"], env=environment)
    row["start"], row["start memory"] = timed([program, "batch", batch, "--cells", batch_folder / "cluster/chunks/0001.json", "-o", batch_folder / "first", "-q"], env=environment)
    Chunks(template).write(batch_folder / "parts", scans // SCANS_PER_CHUNK)
    parts = sorted((batch_folder / "parts").iterdir())
    row["merge"], row["merge memory"] = timed([program, "runs", "merge", *parts, "-o", batch_folder / "result"], env=environment)
    row["records"] = (batch_folder / "result/scanmill.sqlite").stat().st_size
    row["report"], row["report memory"] = timed([program, "report", batch_folder / "result"], env=environment)
    if with_page:
        row["page"], row["page memory"] = timed([program, "report", batch_folder / "result", "--html", batch_folder / "page.html"], env=environment)
        row["page size"] = (batch_folder / "page.html").stat().st_size
    shutil.rmtree(batch_folder)
    return row


def extended(rows, name, cells):
    """The line through the last two rows, at so many cells."""
    first, last = rows[-2:]
    slope = (last[name] - first[name]) / (last["cells"] - first["cells"])
    return last[name] + slope * (cells - last["cells"])


def seconds_text(value):
    return f"{value:.2f} s" if value < 10 else f"{value:.0f} s" if value < 600 else f"{value / 60:.0f} min" if value < 36000 else f"{value / 3600:.0f} h"


def bytes_text(value):
    for unit in ["B", "KiB", "MiB", "GiB"]:
        if value < 1024:
            break
        value /= 1024
    return f"{value:.3g} {unit}"


COLUMNS = [("export", seconds_text), ("export memory", bytes_text), ("start", seconds_text), ("start memory", bytes_text), ("merge", seconds_text), ("merge memory", bytes_text),
           ("records", bytes_text), ("report", seconds_text), ("report memory", bytes_text), ("page", seconds_text), ("page memory", bytes_text), ("page size", bytes_text)]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument("--scans", default="500,5000,50000", help="rows of the table, multiples of 100")
    parser.add_argument("--page", type=int, default=50000, help="the most scans for which the report page is made")
    parser.add_argument("--goal", type=int, default=1_000_000, help="scans")
    parser.add_argument("--into", type=pathlib.Path, default=HERE)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        environment = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}
        batch = write_batch(folder, "chunk", SCANS_PER_CHUNK, points=60)
        timed([arguments.program, "batch", batch, "--shard", "1/1", "-o", folder / "template", "-q"], env=environment)
        files, size = tree(folder / "cache")
        written, _ = tree(folder / "template")
        rows = []
        for scans in map(int, arguments.scans.split(",")):
            rows.append(measure(arguments.program, folder, scans, folder / "template", environment, scans <= arguments.page))
            print(rows[-1], flush=True)
    cells = 2 * arguments.goal
    text = ["<!-- Written by bench/scale/simulate.py. Do not edit. -->", "# A million scans, by simulation", "",
            f"Measured with copies of a chunk of {SCANS_PER_CHUNK} scans of 60 points and two variants of each. The last row is the line through the two rows before it.", "",
            "| scans | cells | " + " | ".join(name for name, _ in COLUMNS) + " |", "|" + "---|" * (2 + len(COLUMNS))]
    for row in rows:
        text.append(f"| {row['scans']:,} | {row['cells']:,} | " + " | ".join(show(row[name]) if name in row else "–" for name, show in COLUMNS) + " |")
    text.append(f"| {arguments.goal:,} | {cells:,} | " + " | ".join(
        show(extended(rows, name, cells)) if name in rows[-1] and name in rows[-2] else "–" for name, show in COLUMNS) + " |")
    text += ["", "*start*: a chunk whose steps are all in the cache; it reads the names of all scans of the batch."
             " *page*: the first report page, for which the copies need only the pictures of one chunk.", "",
             f"The cache has {files / (2 * SCANS_PER_CHUNK):.1f} files and {size / (2 * SCANS_PER_CHUNK) / 1024:.1f} KiB per cell, the output folder "
             f"{written / (2 * SCANS_PER_CHUNK):.1f} files per cell. At {arguments.goal:,} scans these are {files / (2 * SCANS_PER_CHUNK) * cells / 1e6:.1f} and "
             f"{written / (2 * SCANS_PER_CHUNK) * cells / 1e6:.1f} million files."]
    print("\n" + "\n".join(text))
    arguments.into.mkdir(parents=True, exist_ok=True)
    (arguments.into / "million.md").write_text("\n".join(text) + "\n")


if __name__ == "__main__":
    sys.exit(main())
