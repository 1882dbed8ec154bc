# SPDX-License-Identifier: GPL-3.0-or-later
"""python -m scanmill._stubs FILE: writes the type stub of the package with the filters that are installed, for editors and type
checkers. The wheel contains the stub of its own filters; run this again after you install another plugin."""
from __future__ import annotations

import inspect
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path

from . import _NAMES
from ._filters import _CALL, Filter, class_name, filters

_TYPES = {
    "boolean": "bool",
    "integer": "int",
    "number": "float",
    "length": "str | float",
    "angle": "str",
    "ratio": "str | float",
    "text": "str",
    "path": "str | os.PathLike[str]",
}
_CALL_TYPES = {
    "progress": "Callable[[float], None] | bool | None",
    "seed": "int",
    "threads": "int",
    "isolated": "bool",
    "memory_limit": "int",
    "time_limit": "float",
}

_HEAD = '''\
# Written by python -m scanmill._stubs.
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal

import numpy as np

'''


def _port_type(port: dict) -> str:
    kinds = [port["kind"], *port.get("also", [])]
    names = [class_name(kind) for kind in kinds] + (["np.ndarray"] if "points" in kinds else [])
    one = " | ".join(names)
    text = f"Sequence[{one}] | {one}" if port.get("list") else one
    return f"{text} | None" if port.get("optional") else text


def _parameter_type(spec: dict) -> str:
    if spec["type"] == "choice":
        one = f"Literal[{', '.join(repr(choice['name']) for choice in spec['choices'])}]"
    else:
        one = _TYPES[spec["type"]]
    if spec.get("word"):
        one = one if "str" in one.split(" | ") else f"{one} | Literal[{spec['word']!r}]"
    text = f"Sequence[{one}]" if spec.get("list") else one
    if spec.get("list") and spec.get("word"):
        text += f" | Literal[{spec['word']!r}]"
    return text if spec.get("required") else f"{text} | None"


def _stub(name: str, function: Callable) -> str:
    filter_ = Filter(name)
    parts, has_star = [], False
    for parameter in inspect.signature(function).parameters.values():
        if parameter.kind is inspect.Parameter.KEYWORD_ONLY and not has_star:
            has_star = True
            parts.append("*")
        own = parameter.name
        if own in filter_.ports:
            type_ = _port_type(filter_.ports[own])
        elif own in filter_.parameters:
            type_ = _parameter_type(filter_.parameters[own])
        else:
            type_ = _CALL_TYPES[own]
        parts.append(f"{own}: {type_}" + ("" if parameter.default is inspect.Parameter.empty else f" = {parameter.default!r}"))
    output = filter_.declaration["outputs"][0]
    result = "Any" if output.get("like") else class_name(output["kind"])
    page = textwrap.indent(filter_.page().replace("\\", "\\\\"), "    ").strip()
    return f'def {filter_.function}({", ".join(parts)}) -> {result}:\n    """{page}\n    """\n    ...\n'


def stub() -> str:
    imports = "".join(f"from .{module} import {', '.join(f'{name} as {name}' for name in names)}\n" for module, names in _NAMES.items())
    head = "prefix: str\n__version__: str\n\n"
    return _HEAD + imports + "\n" + head + "\n".join(_stub(name, filters[name]) for name in filters)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m scanmill._stubs FILE")
    Path(sys.argv[1]).write_text(stub(), encoding="utf-8")
