# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of other packages. Each package is imported when it is needed."""
from __future__ import annotations

from typing import Any

import numpy as np

from ._kinds import Features, Mesh, Points, Tets, Value


def _imported(name: str) -> Any:
    from importlib import import_module

    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        if error.name != name:
            raise
        raise ModuleNotFoundError(f"this needs the package {name}: pip install {name}", name=name) from None


def _require(value: Any, *kinds: type[Value]) -> None:
    if not isinstance(value, kinds):
        raise TypeError(f"expected {' or '.join(kind.__name__ for kind in kinds)}; it was given {type(value).__name__}")


def _copies(columns: dict[str, Any]) -> dict[str, np.ndarray]:
    """The columns with numbers in every row. Other packages change their arrays, so they get copies."""
    return {name: np.array(column) for name, column in columns.items() if not isinstance(column, tuple)}


def to_trimesh(value: Mesh | Points) -> Any:
    """A trimesh.Trimesh or trimesh.PointCloud, in world coordinates. Triangles keep their order;
    normals and colours are the mesh's own, other columns become attributes."""
    trimesh = _imported("trimesh")
    _require(value, Mesh, Points)
    if isinstance(value, Points):
        return trimesh.PointCloud(np.array(value.world_positions), colors=_copies(value.columns).get("colour"))
    columns = _copies(value.vertex_columns)
    mesh = trimesh.Trimesh(
        np.array(value.world_positions),
        value.triangles.astype(np.int64),
        vertex_normals=columns.pop("normal", None),
        vertex_colors=columns.pop("colour", None),
        vertex_attributes=columns,
        face_attributes=_copies(value.face_columns),
        process=False,
    )
    mesh.units = value.unit
    return mesh


def from_trimesh(mesh: Any, *, unit: str | None = None) -> Mesh | Points:
    """Mesh of a trimesh.Trimesh, or Points of a trimesh.PointCloud. The unit is the mesh's own unless it is given."""
    trimesh = _imported("trimesh")
    if isinstance(mesh, trimesh.PointCloud):
        colours = {} if mesh.colors is None or not len(mesh.colors) else {"colour": np.asarray(mesh.colors, np.uint8)}
        return Points(np.asarray(mesh.vertices), colours, unit=unit)
    if not isinstance(mesh, trimesh.Trimesh):
        raise TypeError(f"expected a trimesh.Trimesh or trimesh.PointCloud; it was given {type(mesh).__name__}")
    known = {"mm": "mm", "millimeters": "mm", "cm": "cm", "m": "m", "meters": "m", "in": "in", "inches": "in", "feet": "ft", "ft": "ft", "um": "um"}
    columns = {name: np.asarray(column) for name, column in mesh.vertex_attributes.items()}
    if mesh.visual.kind == "vertex":
        columns["colour"] = np.asarray(mesh.visual.vertex_colors, np.uint8)
    return Mesh(
        np.asarray(mesh.vertices),
        np.asarray(mesh.faces),
        vertex_columns=columns,
        face_columns={name: np.asarray(column) for name, column in mesh.face_attributes.items()},
        unit=unit or known.get(mesh.units),
    )


def to_open3d(value: Mesh | Points) -> Any:
    """An open3d.geometry.TriangleMesh or PointCloud, in world coordinates, with normals and colours."""
    open3d = _imported("open3d")
    _require(value, Mesh, Points)

    def vector(rows: Any) -> Any:
        return open3d.utility.Vector3dVector(np.array(rows, np.float64))  # it takes no read-only array

    columns = value.columns if isinstance(value, Points) else value.vertex_columns
    if isinstance(value, Points):
        made = open3d.geometry.PointCloud(vector(value.world_positions))
        prefix = ""
    else:
        made = open3d.geometry.TriangleMesh(vector(value.world_positions), open3d.utility.Vector3iVector(value.triangles.astype(np.int32)))
        prefix = "vertex_"
    if "normal" in columns:
        setattr(made, prefix + "normals", vector(columns["normal"]))
    if "colour" in columns:
        setattr(made, prefix + "colors", vector(columns["colour"][:, :3] / 255.0))
    return made


def from_open3d(geometry: Any, *, unit: str | None = None) -> Mesh | Points:
    """Points of an open3d.geometry.PointCloud, or Mesh of a TriangleMesh, with normals and colours."""
    open3d = _imported("open3d")
    if isinstance(geometry, open3d.geometry.PointCloud):
        positions, normals, colours = geometry.points, geometry.normals, geometry.colors
    elif isinstance(geometry, open3d.geometry.TriangleMesh):
        positions, normals, colours = geometry.vertices, geometry.vertex_normals, geometry.vertex_colors
    else:
        raise TypeError(f"expected an open3d.geometry.PointCloud or TriangleMesh; it was given {type(geometry).__name__}")
    columns = {}
    if len(normals):
        columns["normal"] = np.array(normals)
    if len(colours):
        columns["colour"] = np.rint(np.clip(np.asarray(colours), 0, 1) * 255).astype(np.uint8)
    if isinstance(geometry, open3d.geometry.PointCloud):
        return Points(np.array(positions), columns, unit=unit)
    return Mesh(np.array(positions), np.asarray(geometry.triangles), vertex_columns=columns, unit=unit)


def to_pyvista(value: Points | Mesh | Tets | Features) -> Any:
    """A pyvista.PolyData of points, a mesh or the lines of features, or an UnstructuredGrid of tetrahedra, in world coordinates."""
    pyvista = _imported("pyvista")
    _require(value, Points, Mesh, Tets, Features)
    if isinstance(value, Tets):
        cells = np.column_stack([np.full(len(value.cells), 4), value.cells.astype(np.int64)])
        grid = pyvista.UnstructuredGrid(cells.ravel(), np.full(len(value.cells), pyvista.CellType.TETRA, np.uint8), np.array(value.world_positions))
        if value.inside is not None:
            grid.cell_data["inside"] = np.array(value.inside)
        return grid
    if isinstance(value, Features):
        loops = [np.append(line.vertices, line.vertices[:1]) if line.closed else line.vertices for line in value.lines]
        cells = np.concatenate([np.concatenate([[len(loop)], loop]) for loop in loops]).astype(np.int64) if loops else np.zeros(0, np.int64)
        made = pyvista.PolyData(np.array(value.world_positions), lines=cells)
        made.cell_data["type"] = [line.type for line in value.lines]
        return made
    if isinstance(value, Points):
        made = pyvista.PolyData(np.array(value.world_positions))
        columns = value.columns
    else:
        made = pyvista.PolyData.from_regular_faces(np.array(value.world_positions), value.triangles.astype(np.int64))
        columns = value.vertex_columns
        for name, column in _copies(value.face_columns).items():
            made.cell_data[name] = column
    for name, column in _copies(columns).items():
        made.point_data[name] = column
    return made
