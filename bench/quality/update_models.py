# SPDX-License-Identifier: GPL-3.0-or-later
"""Models that tight-cocone makes of scans, at three densities, for the benches of mesh-update."""
from __future__ import annotations

import pathlib
import sys
from argparse import Namespace

import numpy

BENCH = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH), str(BENCH / "quality")]

from tables import scanmill  # noqa: E402
from tables.ply import write_ply  # noqa: E402
from update_cases import Model  # noqa: E402
from update_solids import Mesh, is_closed  # noqa: E402

WORKFLOW = BENCH.parent / "workflows" / "tight-cocone.yaml"
#: Our models and their Euler numbers. Names are files below --data; the kitten is a cloud that comes with normals.
SCANNED = {"kitten": ("points_3/kitten.xyz", 0), "fandisk": ("meshes/fandisk_large.off", 2),
           "anchor": ("meshes/anchor_dense.off", -6)}
#: Edges of the voxels of the thinned scans, in percent of the diagonal: about 28,000, 10,000 and 3,000 points.
VOXELS = (0.7, 1.15, 2.0)
LENGTH = 100.0  #: of a model's longest extent


def load(file: pathlib.Path) -> Mesh:
    import trimesh

    made = trimesh.load(file, process=False)
    return Mesh(numpy.asarray(made.vertices, float), numpy.asarray(made.faces, int))


def surface_of(program: pathlib.Path, points: pathlib.Path, folder: pathlib.Path, limit: float) -> pathlib.Path:
    """The mesh that tight-cocone makes of the points."""
    report = scanmill.run(program, WORKFLOW, [points], folder, limit)
    files = [one["file"] for one in report["cells"][0]["outputs"] if one["outcome"] == "ok"]
    found = [pathlib.Path(file) for file in files if file.endswith(".ply")]
    if not found:
        raise scanmill.Broken(f"{points}: no mesh by tight-cocone: {report['cells'][0].get('error')}")
    return found[0]


def scanned(options: Namespace, model: pathlib.Path, voxel: float, folder: pathlib.Path) -> pathlib.Path:
    scanmill.run(options.program, BENCH / "quality" / "woo-dey-cloud.yaml", [model], folder, options.limit,
                 settings={"bin-size": f"{voxel} %diag"})
    return folder / f"{model.stem}.xyz"


def made_by_tight_cocone(options: Namespace, folder: pathlib.Path) -> tuple[dict[str, list[Model]], list[str]]:
    """The models by name, and sentences about those that are not there."""
    found: dict[str, list[Model]] = {}
    missing = []
    for name, (file, euler) in SCANNED.items():
        path = options.data / file
        if not path.exists():
            path = next((one for one in sorted(options.more_data.glob(f"*/{path.name}"))), path)
        if not path.exists():
            missing.append(f"{file} is not there; `make data` fetches it")
            continue
        shape = surface_of(options.program, path, folder / name, options.limit) if path.suffix == ".xyz" else path
        for voxel in VOXELS:
            into = folder / f"{name}-{voxel}"
            mesh = load(surface_of(options.program, scanned(options, shape, voxel, into), into / "mesh", options.limit))
            if not is_closed(mesh) or mesh.euler != euler:
                missing.append(f"{name} with voxels of {voxel} %diag: tight-cocone gives the Euler number "
                               f"{mesh.euler} instead of {euler}")
                continue
            scale = LENGTH / float(mesh.extents.max())
            found.setdefault(name, []).append(Model(name, "tight cocone", Mesh(mesh.vertices * scale, mesh.faces)))
    return found, missing


def write(folder: pathlib.Path, name: str, mesh: Mesh) -> pathlib.Path:
    folder.mkdir(parents=True, exist_ok=True)
    write_ply(folder / name, mesh.vertices, mesh.faces)
    return folder / name


def load_points(file: pathlib.Path) -> numpy.ndarray:
    import trimesh

    return numpy.asarray(trimesh.load(file, process=False).vertices, float)
