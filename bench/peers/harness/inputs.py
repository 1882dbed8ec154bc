# SPDX-License-Identifier: GPL-3.0-or-later
"""What the rows work on: real scans and seeded shapes, as raw arrays that every program reads alike.

NAME.points holds three doubles per point, all of them exactly representable as float, so that programs that store
floats work on the same points; NAME.triangles, where there are any, three 32-bit indices each, NAME.weights a double per point.
"""
import pathlib
import subprocess


class Missing(Exception):
    """An input cannot be had. The row fails: without its input nobody has won anything."""


class Input:
    """A file, made when its row runs. `describe` is read in the results."""

    def __init__(self, describe, path, make):
        self.describe = describe
        self.path = pathlib.Path(path)
        self._make = make
        self.facts = {}

    def make(self):
        """Raises Missing with a sentence."""
        self._make(self.path)
        if self.path.with_suffix(".points").exists():
            self.facts["points"] = self.path.with_suffix(".points").stat().st_size // 24
        if self.path.with_suffix(".triangles").exists():
            self.facts["triangles"] = self.path.with_suffix(".triangles").stat().st_size // 12

    def load(self):
        """The request that makes a program load it."""
        return {"do": "load", "path": str(self.path.with_suffix(""))}


class Inputs:
    """Where they lie: `data` what `make data` fetched, `folder` what is made of it by the program `maker`."""

    def __init__(self, data, folder, maker):
        self.data, self.folder, self.maker = pathlib.Path(data), pathlib.Path(folder), pathlib.Path(maker)

    def scan(self, name, file):
        """The vertices, in the file's order, and triangles of a file below build/data, rounded to float."""
        return Input(f"{file}, as read", self.folder / name, lambda path: self._convert(self.data / file, path))

    def torus(self, count):
        """Points that keep their distance from each other on a torus with radii 1 and 0.4 and bumps, seed 1."""
        name = f"torus-{count}"
        describe = "bumpy torus (radii 1 and 0.4), evenly spread points in random order, seed 1"
        return Input(describe, self.folder / name, lambda path: self._run_maker(path, [], ["torus", str(count)]))

    def random_torus(self, count):
        """Points uniform by area on a plain torus with these radii, each on its own, seed 1: quickly made."""
        describe = "torus (radii 1 and 0.4), points uniform by area in random order, seed 1"
        name = f"random-torus-{count}"
        return Input(describe, self.folder / name, lambda path: self._run_maker(path, [], ["random-torus", str(count)]))

    def weighted(self, cloud):
        """The same points, each with the weight that `delaunay: {weights: spacing}` gives it, in NAME.weights."""

        def make(path):
            cloud.make()
            self._run_maker(path, [cloud.path.with_suffix(".points")], ["weighted", str(cloud.path)])

        return Input(f"{cloud.describe}; weights of their spacing", self.folder / f"weighted-{cloud.path.name}", make)

    def around(self, mesh, count):
        """Seeded points near a mesh: uniform on its surface, then moved by up to 1 % of its diagonal on each axis."""

        def make(path):
            mesh.make()
            self._run_maker(path, [mesh.path.with_suffix(".points")], ["around", str(mesh.path), str(count)])

        return Input("points around it, seed 1", self.folder / f"around-{mesh.path.name}-{count}", make)

    def _convert(self, source, path):
        if not source.exists():
            raise Missing(f"{source} is not there; `make data` fetches it (the dragon through npm)")
        self._run_maker(path, [source], ["scan", str(source)])

    def _run_maker(self, path, sources, arguments):
        """Unless the result is newer than everything it is made from."""
        made = path.with_suffix(".points")
        if not self.maker.exists():
            raise Missing(f"{self.maker} is not built, which makes the inputs; `make bench-peers` builds it")
        if made.exists() and all(made.stat().st_mtime > one.stat().st_mtime for one in [self.maker, *sources]):
            return
        self.folder.mkdir(parents=True, exist_ok=True)
        done = subprocess.run([self.maker, *arguments, str(path)], stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            raise Missing(f"{path.name} could not be made: {done.stderr.strip() or done.returncode}")
