# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads and writes files."""
from __future__ import annotations

import os
import warnings
from typing import Any

from . import _native
from ._errors import ScanmillWarning
from ._kinds import Value, wrap


def read(
    file: str | os.PathLike, *, unit: str | None = None, invalid: str | None = None, frame: str = "", kind: str | None = None
) -> Any:
    """Reads points, a mesh or any other kind from a file.

    Parameters
    ----------
    file
        PLY, PCD, LAS, LAZ, E57, STL, OBJ, JSON … The content decides the format. "FILE.e57#2" is the second view in a file.
    unit : str, optional
        The unit of the coordinates: "um", "mm", "cm", "m", "in" or "ft". Default: the unit that the file states.
    invalid : str, optional
        "drop" leaves out the points with a NaN or infinite coordinate, "refuse" raises Error. Default: drop in formats that
        write NaN for a ray without a return, else refuse.
    frame : str, optional
        Name of the coordinate system.
    kind : str, optional
        Require this kind. "points" takes the vertices of a mesh file.

    Returns
    -------
    Points, Mesh or another kind

    Warns of everything that was left out or changed.
    """
    if invalid not in (None, "drop", "refuse"):
        raise ValueError(f"invalid is {invalid!r}; expected 'drop' or 'refuse'")
    native, sentences = _native.read(os.fspath(file), kind, unit, frame, invalid or "")
    for sentence in sentences:
        warnings.warn(sentence, ScanmillWarning, stacklevel=2)
    return wrap(native)


def write(value: Value, file: str | os.PathLike) -> None:
    """Writes a value in the format of the file's extension. The file appears whole or not at all; an existing file is
    replaced. Warns of everything that the format cannot hold."""
    if not isinstance(value, Value):
        raise TypeError(f"write() takes a value of Scanmill, such as Points or Mesh; it was given {type(value).__name__}")
    for sentence in _native.write(value._native, os.fspath(file)):
        warnings.warn(sentence, ScanmillWarning, stacklevel=2)
