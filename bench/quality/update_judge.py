# SPDX-License-Identifier: GPL-3.0-or-later
"""Judges an updated mesh against the truth of its case, independently of the program's metrics."""
from __future__ import annotations

import pathlib
from dataclasses import dataclass

import numpy

import update_cases
from update_cases import Case, distances
from update_solids import Array, Mesh, is_closed

#: The outcomes, from best to worst.
OUTCOMES = {
    "right": "right",
    "right, doubtful": "right but doubtful",
    "admissible": "refused as admissible",
    "refused": "refused otherwise",
    "wrong, doubtful": "wrong but doubtful",
    "wrong": "wrong in silence",
    "crashed": "no answer",
}
#: With these, the exit code of the sweep is 1.
FATAL = ("wrong", "crashed")

SAMPLES = 20_000
QUANTILE = 99
#: Offsets above this share of the cloud's spacing at the rim may be refused as `registration`. The filter's limit is
#: 0.5; its loop is not exactly our rim.
REGISTRATION = 0.45
RIM = 1.1  #: width of the band that counts as rim, in spacings
#: Largest distance of vertices that resampling adds from the model, in spacings. The search is in float, and may find a
#: neighbour of the nearest triangle where triangles are long.
ROUNDING = 0.01


@dataclass
class Result:
    """An updated mesh with its columns."""

    mesh: Mesh
    source: numpy.ndarray  #: per vertex, 0: the model, j: the j-th cloud
    updated: numpy.ndarray  #: per face, whether it is not a triangle of the model

    @staticmethod
    def load(file: pathlib.Path) -> Result:
        import trimesh

        made = trimesh.load(file, process=False)
        raw = made.metadata["_ply_raw"]
        return Result(Mesh(numpy.asarray(made.vertices, float), numpy.asarray(made.faces, int)),
                      numpy.asarray(raw["vertex"]["data"]["source"]).ravel().astype(int),
                      numpy.asarray(raw["face"]["data"]["updated"]).ravel() == 1)


def rim_offset(case: Case) -> float:
    """The median distance of the cloud's rim from the model, in spacings of the cloud with its errors."""
    rim = case.cloud.ring > case.ring - RIM * case.cloud.spacing
    offset = distances(case.model.mesh, case.cloud.points[rim])
    return float(numpy.median(offset) / update_cases.median_nearest(case.cloud.points))


def admissible(case: Case, rebuild: str) -> list[str]:
    """The refusals that are right answers to this case, decided before the run."""
    allowed = []
    if rim_offset(case) > REGISTRATION:
        allowed.append("registration")
    if rebuild == "local":
        allowed.append("seam")
    return allowed


def bytes_of(rows: Array) -> numpy.ndarray:
    rows = numpy.ascontiguousarray(rows, float) + 0.0  # −0 is 0
    return rows.view([("", "f8")] * 3).ravel()


def faults(case: Case, result: Result, resampled: int) -> tuple[list[str], dict]:
    """What is wrong with the result, and the measured values: lengths in spacings."""
    mesh, truth, h = result.mesh, case.truth, case.cloud.spacing
    found: list[str] = []
    values: dict = {"triangles": len(mesh.faces), "updated": int(result.updated.sum())}
    if not is_closed(mesh):
        found.append("not closed")
    values["euler"] = mesh.euler
    if values["euler"] != truth.euler:
        found.append(f"Euler number {values['euler']} instead of {truth.euler}")

    area = float(mesh.areas[result.updated].sum())
    off = mesh.volume() - truth.volume()
    allowed = (h / 2 + 3 * case.sigma * h) * area
    values["volume"] = off / (h * area) if area else 0.0
    if abs(off) > allowed:
        found.append(f"volume off by {off / allowed:+.2g} of what is allowed")

    limit = 1 + 3 * case.sigma
    random = numpy.random.default_rng([case.seed, case.index, 1])
    if result.updated.any():
        places, _ = update_cases.uniform(mesh.part(result.updated), SAMPLES, random)
        values["to_truth"] = float(numpy.percentile(distances(truth, places), QUANTILE) / h)
    else:
        values["to_truth"] = 0.0
        found.append("nothing was updated")
    dense = case.cloud.dense[random.permutation(len(case.cloud.dense))[:SAMPLES]]
    values["from_truth"] = float(numpy.percentile(distances(mesh, dense), QUANTILE) / h)
    for name, words in (("to_truth", "updated faces are"), ("from_truth", "the truth is")):
        if values[name] > limit:
            found.append(f"{words} {values[name]:.2g} h away instead of {limit:.2g} h")

    used = numpy.unique(mesh.faces)
    kept = used[result.source[used] == 0]
    strange = kept[~numpy.isin(bytes_of(mesh.vertices[kept]), bytes_of(case.model.mesh.vertices))]
    astray = distances(case.model.mesh, mesh.vertices[strange]) if len(strange) else numpy.zeros(0)
    if len(strange) > resampled or (astray > ROUNDING * h).any():
        found.append(f"{len(strange)} kept vertices are not the model's")
    new = used[result.source[used] > 0]
    foreign = int((~numpy.isin(bytes_of(mesh.vertices[new]), bytes_of(case.cloud.points))).sum())
    if foreign:
        found.append(f"{foreign} new vertices are not the cloud's")
    return found, values
