# SPDX-License-Identifier: GPL-3.0-or-later
"""The kinds of values that filters take and give. Their arrays are NumPy arrays that share the memory of the value, so they
are read-only."""
from __future__ import annotations

import atexit
import json
import math
import os
import tempfile
import warnings as python_warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from . import _native
from ._errors import ScanmillWarning

Columns = Mapping[str, Any]

atexit.register(_native.stop_all)


def _shared(given: Any, name: str, type_: Any, shape: tuple[int | None, ...], copy: bool) -> np.ndarray:
    """The array row by row with elements of this type; `type_` None keeps the type. Without `copy`, an array that is right
    already is not copied: it becomes read-only instead, so that it cannot change while a filter reads it."""
    if isinstance(given, np.ma.MaskedArray):
        raise TypeError(f"{name} is a masked array, and values have no mask; take the rows you want: array[~mask.any(axis=1)].data")
    array = np.asarray(given)
    is_index = type_ is not None and np.dtype(type_).kind == "u"
    if array.dtype.kind not in "biuf":
        raise TypeError(f"{name} has the type {array.dtype}; expected numbers")
    if array.ndim != len(shape) or any(want is not None and want != have for want, have in zip(shape, array.shape)):
        wanted = " × ".join("n" if length is None else str(length) for length in shape)
        raise TypeError(f"{name} has the shape {array.shape}; expected {wanted}")
    if type_ is None:
        type_ = {"b": np.uint8}.get(array.dtype.kind, array.dtype.newbyteorder("="))
        if array.dtype.kind == "f" and array.dtype.itemsize not in (4, 8):
            type_ = np.float64 if array.dtype.itemsize > 8 else np.float32
    elif is_index:
        _require_indices(array, name, type_)
    right = np.require(array, type_, ["C_CONTIGUOUS", "ALIGNED"])
    shares = right is array or right.base is not None and np.may_share_memory(right, array)
    # A wrong index would be read beyond the end of an array, so indices that anybody can write are always copied.
    if shares and (copy or right is not array or _others_may_write(right) or (is_index and right.flags.writeable)):
        right = right.copy()
    right.flags.writeable = False
    return right


def _require_indices(array: np.ndarray, name: str, type_: Any) -> None:
    """Indices must be whole numbers in the range of the type, or the conversion would change them."""
    if array.dtype.kind == "f":
        raise TypeError(f"{name} has the type {array.dtype}; expected whole numbers")
    if array.size and (array.min() < 0 or array.max() > np.iinfo(type_).max):
        raise TypeError(f"{name} has indices from {array.min()} to {array.max()}; expected 0 to {np.iinfo(type_).max}")


def _others_may_write(array: np.ndarray) -> bool:
    """Whether the memory can change although the array is read-only: it belongs to another array that is not."""
    base = array.base
    while base is not None:
        if isinstance(base, np.ndarray):
            if base.flags.writeable:
                return True
            base = base.base
        else:
            return array.flags.writeable  # memory of another library: a file that is mapped, a buffer
    return False


def _columns(given: Columns | None, rows: int, copy: bool) -> list[tuple[str, np.ndarray]]:
    listed = []
    for name, column in (given or {}).items():
        if not isinstance(name, str):
            raise TypeError(f"the name of a column is {name!r}; expected a text")
        shape = np.shape(column)
        if isinstance(column, tuple) or len(shape) not in (1, 2) or shape[0] != rows:
            raise TypeError(f"the column '{name}' has the shape {shape}; expected {rows} rows, with one or more numbers each")
        listed.append((name, _shared(column, f"the column '{name}'", None, tuple(None for _ in shape), copy)))
    return listed


def _frame(unit: str | None, origin: Any, frame: str) -> tuple[str | None, tuple[float, float, float], str]:
    x, y, z = (float(number) for number in origin)
    if not all(map(math.isfinite, (x, y, z))):
        raise ValueError(f"the origin is {(x, y, z)}; expected three finite numbers")
    for name, text in (("unit", unit or ""), ("frame", frame)):
        if not isinstance(text, str):
            raise TypeError(f"{name} is {text!r}; expected a text")
    return unit, (x, y, z), frame


class Measured(dict):
    """Numbers by name. `units` has the unit of each: "length", "count", "angle" …; lengths are in `unit`."""

    def __init__(self, numbers: Iterable[tuple[str, float, str]] = (), unit: str | None = None):
        typed = {"boolean": bool, "count": lambda number: int(number) if number == number else number}
        listed = list(numbers)
        super().__init__((name, typed.get(kind, float)(value)) for name, value, kind in listed)
        self.units = {name: kind for name, _, kind in listed}
        self.unit = unit


class Made:
    """How a filter made a value."""

    def __init__(self, filter_: str = "", report: dict[str, Any] | None = None):
        report = report or {"outputs": {}, "parameters": {}, "metrics": [], "unit": None, "warnings": [], "doubts": []}
        self.filter = filter_
        self.values = report["outputs"]
        self.parameters = report["parameters"]
        self.metrics = Measured(report["metrics"], report["unit"])
        self.warnings = list(report["warnings"])
        self.doubts = [text for text, _ in report["doubts"]]


class Value:
    """A value of any kind: what filters take and give. Values never change.

    Attributes
    ----------
    kind : str
        "points", "mesh" …
    unit : str or None
        Unit of its lengths: "mm" …; None if it is not known.
    frame : str
        Name of the coordinate system; may be empty.
    origin : tuple of three floats
        What positions are relative to: the world position is origin + position. Zero unless the positions are far from zero.
    outputs : dict
        All outputs of the filter that gave this value, by port; empty for other values.
    metrics : Measured
        What that filter measured.
    warnings, doubts : list of str
        What that filter warned of, and why its result may not be what you want.
    parameters : dict
        Its parameters as it got them: lengths in the scan's unit.
    """

    def __init__(self, *args: Any, **kwargs: Any):
        raise TypeError(f"{type(self).__name__} cannot be made of arrays; filters, read() and from_document() give it")

    def _hold(self, native: Any, made: Made | None = None) -> None:
        self._native = native
        self._made = made or Made()

    @property
    def kind(self) -> str:
        return self._native.kind

    @property
    def unit(self) -> str | None:
        return self._native.frame()[0]

    @property
    def origin(self) -> tuple[float, float, float]:
        return self._native.frame()[1]

    @property
    def frame(self) -> str:
        return self._native.frame()[2]

    @property
    def outputs(self) -> dict[str, Any]:
        return {port: self if native.is_same(self._native) else wrap(native, self._made) for port, native in self._made.values.items()}

    @property
    def metrics(self) -> Measured:
        return self._made.metrics

    @property
    def warnings(self) -> list[str]:
        return self._made.warnings

    @property
    def doubts(self) -> list[str]:
        return self._made.doubts

    @property
    def parameters(self) -> dict[str, str]:
        return self._made.parameters

    @property
    def properties(self) -> Measured:
        """Counts and topology: triangles, components, genus …"""
        return Measured(self._native.properties(), self.unit)

    def in_unit(self, unit: str) -> Any:
        """The same geometry in another unit: positions and all other lengths are converted."""
        return wrap(self._native.in_unit(unit))

    def write(self, file: str | os.PathLike) -> None:
        """Writes the value in the format of the file's extension. An existing file is replaced."""
        for sentence in _native.write(self._native, os.fspath(file)):
            python_warnings.warn(sentence, ScanmillWarning, stacklevel=2)

    def document(self) -> dict[str, Any]:
        """The value as its JSON form has it, in world coordinates."""
        text = self._native.document()
        if text is None:
            raise TypeError(f"values of the kind '{self.kind}' have no form in JSON")
        return json.loads(text)

    def picture(self, **parameters: Any) -> Picture:
        """Draws the value. Parameters are those of scanmill.render."""
        from ._filters import filters

        return filters["render"](self, **parameters)

    def _repr_png_(self) -> bytes | None:
        return self.picture().png() if self.kind in ("points", "mesh", "features", "patches", "probes") else None

    def _array(self, name: str) -> Any:
        return self._native.arrays()[name]

    def _what(self) -> str:
        return self.kind

    def __repr__(self) -> str:
        return f"<scanmill.{type(self).__name__}: {self._what()}{', ' + self.unit if self.unit else ''}>"

    def __copy__(self) -> Value:
        return self  # values never change

    def __deepcopy__(self, _: Any) -> Value:
        return self

    def __reduce__(self):
        """Pickles the value, without how it was made."""
        with tempfile.TemporaryDirectory(dir="/dev/shm" if os.path.isdir("/dev/shm") else None) as folder:
            file = Path(folder, "value")
            self._native.store(file)
            return _unpickled, (file.read_bytes(),)


def _unpickled(content: bytes) -> Value:
    with tempfile.NamedTemporaryFile() as file:
        file.write(content)
        file.flush()
        return wrap(_native.stored(file.name))


class _Document(Value):
    """A kind that is one document."""

    _kind: str

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> Any:
        """The value of a document, as document() gives it."""
        native, sentences = _native.value(cls._kind, json.dumps(document))
        for sentence in sentences:
            python_warnings.warn(sentence, ScanmillWarning, stacklevel=2)
        return wrap(native)


class _Positions(Value):
    @property
    def positions(self) -> np.ndarray:
        """n × 3 coordinates, relative to `origin`."""
        return self._array("positions")

    @property
    def world_positions(self) -> np.ndarray:
        """n × 3 coordinates: `origin` + `positions`."""
        origin = self.origin
        return self.positions if origin == (0, 0, 0) else self.positions + np.array(origin)

    def _with_positions(self, positions: Any, copy: bool) -> Any:
        return wrap(self._native.with_positions(_shared(positions, "positions", np.float64, (None, 3), copy)))


class Points(_Positions):
    """A scan: n positions, with columns of n rows ("normal", "colour" …).

    An array of n × 3 doubles is not copied. It becomes read-only, because values never change; pass `copy=True` to keep an
    array that you will change. A view of an array that can still change is always copied, and so is any other type.

    Parameters
    ----------
    positions : n × 3 numbers
    columns : dict, optional
        Name to n or n × k numbers. Well-known names: "normal" (n × 3), "colour" (n × 3 or n × 4 of uint8), "weight".
    unit : str, optional
        "um", "mm", "cm", "m", "in" or "ft".
    invalid : str, optional
        "drop" leaves out the rows with a NaN or infinite coordinate; otherwise they are refused.
    origin, frame
        See Value.
    """

    def __init__(
        self,
        positions: Any,
        columns: Columns | None = None,
        *,
        unit: str | None = None,
        invalid: str = "refuse",
        origin: Any = (0.0, 0.0, 0.0),
        frame: str = "",
        copy: bool = False,
    ):
        if invalid not in ("drop", "refuse"):
            raise ValueError(f"invalid is {invalid!r}; expected 'drop' or 'refuse'")
        rows = _shared(positions, "positions", np.float64, (None, 3), copy)
        self._hold(_native.points(rows, _columns(columns, len(rows), copy), _frame(unit, origin, frame), invalid))

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """Name to n or n × k numbers; a column of lists is a pair of offsets and numbers."""
        return self._array("columns")

    def __len__(self) -> int:
        return len(self.positions)

    def with_positions(self, positions: Any, *, copy: bool = False) -> Points:
        """The same points with other positions, relative to `origin`. Columns keep their rows and their units of length."""
        return self._with_positions(positions, copy)

    def _what(self) -> str:
        return f"{len(self):,} points"


class Mesh(_Positions):
    """Triangles between positions. Copies as Points do.

    Parameters
    ----------
    positions : n × 3 numbers
    triangles : m × 3 whole numbers
        Rows of positions, counter-clockwise seen from outside.
    vertex_columns, face_columns : dict, optional
        Name to n or m rows.
    sharp_edges : k × 2 whole numbers, optional
    unit, origin, frame, copy
        See Points and Value.
    """

    def __init__(
        self,
        positions: Any,
        triangles: Any,
        *,
        vertex_columns: Columns | None = None,
        face_columns: Columns | None = None,
        sharp_edges: Any = None,
        unit: str | None = None,
        origin: Any = (0.0, 0.0, 0.0),
        frame: str = "",
        copy: bool = False,
    ):
        rows = _shared(positions, "positions", np.float64, (None, 3), copy)
        faces = _shared(triangles, "triangles", np.uint32, (None, 3), copy)
        given = np.zeros((0, 2), np.uint32) if sharp_edges is None else sharp_edges
        sorted_edges = np.unique(np.sort(_shared(given, "sharp_edges", np.uint32, (None, 2), True)), axis=0)
        edges = _shared(sorted_edges, "sharp_edges", np.uint32, (None, 2), False)
        self._hold(
            _native.mesh(
                rows,
                faces,
                _columns(vertex_columns, len(rows), copy),
                _columns(face_columns, len(faces), copy),
                edges,
                _frame(unit, origin, frame),
            )
        )

    @property
    def triangles(self) -> np.ndarray:
        """m × 3 rows of `positions`, counter-clockwise seen from outside."""
        return self._array("triangles")

    @property
    def vertex_columns(self) -> dict[str, np.ndarray]:
        return self._array("vertex-columns")

    @property
    def face_columns(self) -> dict[str, np.ndarray]:
        return self._array("face-columns")

    @property
    def edges(self) -> np.ndarray:
        """The edges that `edge_columns` describe."""
        return self._array("edges")

    @property
    def edge_columns(self) -> dict[str, np.ndarray]:
        return self._array("edge-columns")

    @property
    def sharp_edges(self) -> np.ndarray:
        return self._array("sharp-edges")

    def to_trimesh(self) -> Any:
        """A trimesh.Trimesh of the same triangles, in world coordinates."""
        from ._others import to_trimesh

        return to_trimesh(self)

    def with_positions(self, positions: Any, *, copy: bool = False) -> Mesh:
        """The same mesh with other positions, relative to `origin`. Columns keep their rows and their units of length."""
        return self._with_positions(positions, copy)

    def _what(self) -> str:
        return f"{len(self.positions):,} vertices, {len(self.triangles):,} triangles"


class Tets(_Positions):
    """Tetrahedra between positions, each with its neighbours and, after some filters, whether it is inside a solid."""

    @property
    def cells(self) -> np.ndarray:
        """m × 4 rows of `positions`."""
        return self._array("cells")

    @property
    def neighbours(self) -> np.ndarray:
        """m × 4 rows of `cells`: the cell opposite to each corner; 2³² - 1 outside the hull."""
        return self._array("neighbours")

    @property
    def inside(self) -> np.ndarray | None:
        """m numbers: 1 inside the solid, 0 outside; None without a solid."""
        labels = self._array("inside")
        return labels if len(labels) else None

    @property
    def weights(self) -> np.ndarray | None:
        """n squared lengths; None without weights."""
        numbers = self._array("weights")
        return numbers if len(numbers) else None

    @property
    def vertex_columns(self) -> dict[str, np.ndarray]:
        return self._array("vertex-columns")

    def _what(self) -> str:
        return f"{len(self.positions):,} vertices, {len(self.cells):,} tetrahedra"


class Line:
    """A line of a feature graph: its type ("outer boundary", "hole" or "crease"), whether it is closed, and the rows of its
    vertices among the graph's positions."""

    def __init__(self, graph: Features, type_: str, closed: bool, vertices: np.ndarray):
        self._graph = graph
        self.type = type_
        self.closed = closed
        self.vertices = vertices

    @property
    def positions(self) -> np.ndarray:
        return self._graph.positions[self.vertices]

    def __repr__(self) -> str:
        return f"<scanmill.Line: {self.type}, {'closed' if self.closed else 'open'}, {len(self.vertices)} vertices>"


class Features(_Positions, _Document):
    """Boundaries and sharp edges of a mesh as lines, with their corners."""

    _kind = "features"

    @property
    def vertices(self) -> np.ndarray:
        """Rows of `positions`, line after line."""
        return self._array("vertices")

    @property
    def lines(self) -> list[Line]:
        arrays = self._native.arrays()
        return [Line(self, type_, closed, arrays["vertices"][begin:end]) for type_, closed, begin, end in arrays["polylines"]]

    @property
    def corners(self) -> np.ndarray:
        """Rows of `positions`."""
        return self._array("corners")

    @property
    def left_normals(self) -> np.ndarray:
        return self._array("left-normals")

    @property
    def right_normals(self) -> np.ndarray:
        return self._array("right-normals")

    def _what(self) -> str:
        return f"{len(self._array('polylines')):,} lines, {len(self.corners):,} corners"


class Patches(_Positions, _Document):
    """A smooth surface: the zero set of one cubic polynomial per tetrahedron."""

    _kind = "patches"

    @property
    def tets(self) -> np.ndarray:
        return self._array("tets")

    @property
    def weights(self) -> np.ndarray:
        """m × 20 Bernstein–Bézier weights."""
        return self._array("weights")

    def _what(self) -> str:
        return f"{len(self.tets):,} patches"


class Probes(_Document):
    """Where a touch probe measures the edges of a part: touches and moves."""

    _kind = "probes"

    @property
    def touches(self) -> list[dict[str, Any]]:
        return self.document()["touches"]

    @property
    def moves(self) -> list[dict[str, Any]]:
        return self.document()["moves"]

    def _what(self) -> str:
        return f"{len(self.touches):,} touches"


class Transforms(_Document):
    """Rigid motions, each from a frame to a frame. Iterates over 4 × 4 matrices, which move world positions.

    Parameters
    ----------
    matrices : 4 × 4 or n × 4 × 4 numbers
        Rotation and translation.
    scans : list of str, optional
        The frame, or the scan, from which each motion starts. Needed for more than one.
    frame : str, optional
        The frame to which all lead.
    unit : str, optional
        Unit of the translations.
    """

    _kind = "transform"

    def __init__(self, matrices: Any, scans: Sequence[str] = (), *, frame: str = "", unit: str | None = None):
        motions = np.asarray(matrices, np.float64).reshape(-1, 4, 4).tolist()
        if scans and len(scans) != len(motions):
            raise ValueError(f"scans has {len(scans)} names; expected {len(motions)}, one per matrix")
        poses: list[dict[str, Any]] = [{"matrix": matrix} for matrix in motions]
        for pose, scan in zip(poses, scans):
            pose["scan"] = scan
        document: dict[str, Any] = {"scanmill": 1, "unit": unit, "frame": frame or None, "poses": poses}
        self._hold(_native.value(self._kind, json.dumps(document))[0])

    @property
    def matrices(self) -> np.ndarray:
        """n × 4 × 4."""
        return self._array("matrices")

    @property
    def names(self) -> list[tuple[str, str]]:
        """The frames from which and to which each motion leads."""
        return self._array("names")

    def __len__(self) -> int:
        return len(self.matrices)

    def __iter__(self) -> Iterator[np.ndarray]:
        return iter(self.matrices)

    def _what(self) -> str:
        return f"{len(self)} motion{'' if len(self) == 1 else 's'}"


class Metrics(_Document):
    """Named numbers, as an output of a filter. `values` has them as a dict."""

    _kind = "metrics"

    @property
    def values(self) -> Measured:
        return Measured(self._array("values"), self._array("unit"))

    def _what(self) -> str:
        return f"{len(self.values)} numbers"


class Picture(Value):
    """An image with a caption."""

    @property
    def pixels(self) -> np.ndarray:
        """rows × columns × 3: red, green, blue."""
        return self._array("pixels")

    @property
    def caption(self) -> str:
        return self._array("caption")

    def png(self) -> bytes:
        """The bytes of a PNG file."""
        return _native.png(self._native)

    def _repr_png_(self) -> bytes:
        return self.png()

    def _what(self) -> str:
        rows, columns, _ = self.pixels.shape
        return f"{columns} × {rows} pixels"


KINDS: dict[str, type[Value]] = {
    "points": Points,
    "mesh": Mesh,
    "tets": Tets,
    "features": Features,
    "patches": Patches,
    "probes": Probes,
    "transform": Transforms,
    "metrics": Metrics,
    "picture": Picture,
}


def wrap(native: _native.Value, made: Made | None = None) -> Any:
    """The value as an object of its kind's class. Kinds of other people's modules are plain values."""
    value = object.__new__(KINDS.get(native.kind, Value))
    value._hold(native, made)
    return value
