# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of the rows: real scans and seeded shapes, as raw arrays for all programs.

NAME.points holds three doubles per point, each exactly representable as float, so that programs that store floats work
on the same points. NAME.triangles (optional) holds three 32-bit indices per triangle, NAME.weights (optional) a double
per point, NAME.normals (optional) three doubles per point.
"""
import pathlib
import subprocess


class Missing(Exception):
    """An input is not available. Its row fails."""


class Input:
    """A file, made when its row runs. The results contain `describe`."""

    def __init__(self, describe, path, make):
        self.describe = describe
        self.path = pathlib.Path(path)
        self._make = make
        self.facts = {}

    def make(self):
        """Makes the file if necessary. Raises Missing with a sentence."""
        self._make(self.path)
        if self.path.with_suffix(".points").exists():
            self.facts["points"] = self.path.with_suffix(".points").stat().st_size // 24
        if self.path.with_suffix(".triangles").exists():
            self.facts["triangles"] = self.path.with_suffix(".triangles").stat().st_size // 12

    def load(self):
        """The request that makes a program load the input."""
        return {"do": "load", "path": str(self.path.with_suffix(""))}


class Inputs:
    """The inputs. `data` holds what `make data` fetched; the program `maker` writes the arrays to `folder`."""

    def __init__(self, data, folder, maker):
        self.data, self.folder, self.maker = pathlib.Path(data), pathlib.Path(folder), pathlib.Path(maker)

    def scan(self, name, file):
        """Vertices (in the order of the file) and triangles of a file below build/data, rounded to float."""
        return Input(f"{file}, as read", self.folder / name, lambda path: self._convert(self.data / file, path))

    def torus(self, count):
        """Evenly spread points on a torus with bumps, radii 1 and 0.4, seed 1."""
        name = f"torus-{count}"
        describe = "bumpy torus (radii 1 and 0.4), evenly spread points in random order, seed 1"
        return Input(describe, self.folder / name, lambda path: self._run_maker(path, [], ["torus", str(count)]))

    def random_torus(self, count):
        """Independent points, uniform by area, on a torus without bumps, radii 1 and 0.4, seed 1. Fast to make."""
        describe = "torus (radii 1 and 0.4), points uniform by area in random order, seed 1"
        name = f"random-torus-{count}"
        return Input(describe, self.folder / name, lambda path: self._run_maker(path, [], ["random-torus", str(count)]))

    def weighted(self, cloud):
        """The same points with the weights of `delaunay: {weights: spacing}` in NAME.weights."""

        return self._made_of("weighted", cloud, "weights of their spacing")

    def oriented(self, mesh):
        """The vertices of a mesh with its normals in NAME.normals, and without its triangles."""
        return self._made_of("oriented", mesh, "vertices with normals of the mesh")

    def displaced(self, mesh, count):
        """Seeded points on a mesh with noise of 0.02 % of its diagonal, turned by 1 degree and moved by 1 % of it."""
        return self._made_of("displaced", mesh, "points on it with noise, 1 degree and 1 % away, seed 1", str(count))

    def soup(self, mesh):
        """The triangles of a mesh, each with three points of its own, and every third one reversed."""
        return self._made_of("soup", mesh, "every triangle with its own points, every third one reversed")

    def holes(self, mesh, count):
        """The mesh without the triangles within four edges of `count` vertices."""
        return self._made_of("holes", mesh, f"without the triangles within four edges of {count} vertices", str(count))

    def around(self, mesh, count):
        """Seeded points near a mesh: uniform on it, then moved by up to 1 % of its diagonal along each axis."""

        around = self._made_of("around", mesh, "", str(count))
        around.describe = "points around it, seed 1"
        return around

    def _made_of(self, kind, source, what, *arguments):
        """An input that the maker's command `kind` makes of another input."""

        def make(path):
            source.make()
            self._run_maker(path, [source.path.with_suffix(".points")], [kind, str(source.path), *arguments])

        name = "-".join([kind, source.path.name, *arguments])
        return Input(f"{source.describe}; {what}", self.folder / name, make)

    def _convert(self, source, path):
        if not source.exists():
            raise Missing(f"{source} is not there; `make data` fetches it (the dragon needs npm)")
        self._run_maker(path, [source], ["scan", str(source)])

    def _run_maker(self, path, sources, arguments):
        """Runs the maker unless the result is newer than its sources."""
        made = path.with_suffix(".points")
        if not self.maker.exists():
            raise Missing(f"{self.maker}, which makes the inputs, is not built; `make bench-peers` builds it")
        if made.exists() and all(made.stat().st_mtime > one.stat().st_mtime for one in [self.maker, *sources]):
            return
        self.folder.mkdir(parents=True, exist_ok=True)
        done = subprocess.run([self.maker, *arguments, str(path)], stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            raise Missing(f"{path.name} could not be made: {done.stderr.strip() or done.returncode}")
