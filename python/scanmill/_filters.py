# SPDX-License-Identifier: GPL-3.0-or-later
"""Every installed filter as a function, made from the filter's declaration."""
from __future__ import annotations

import inspect
import json
import keyword
import os
import re
import textwrap
import warnings
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from . import _native
from ._errors import DoubtWarning, Error, ScanmillWarning
from ._kinds import KINDS, Made, Points, Value, wrap
from ._program import program

#: What every function takes beside the filter's own inputs and parameters.
_CALL = {
    "progress": (None, "callable or True", "Called with the fraction that is done, from 0 to 1. True shows a bar."),
    "seed": (0, "int", "Seed of all random numbers."),
    "threads": (0, "int", "Number of threads; 0: all cores. The result does not depend on it."),
    "isolated": (False, "bool", "Run in a process of its own, so that a crash does not end this one."),
    "memory_limit": (0, "int", "With `isolated`: largest memory in bytes; 0: no limit."),
    "time_limit": (0.0, "float", "With `isolated`: longest time in seconds; 0: no limit."),
}


def python_name(name: str, taken: set[str]) -> str:
    """The name with underscores. Another underscore follows if Python or the function itself has the name already."""
    plain = name.replace("-", "_")
    return plain + "_" if keyword.iskeyword(plain) or plain in taken else plain


class Filter:
    """The declaration of a filter, with the names that its function has for ports and parameters."""

    def __init__(self, name: str):
        self.declaration = json.loads(_native.declaration(name))
        self.name = name
        self.function = name.replace("-", "_")
        taken = set(_CALL)
        self.ports: dict[str, dict] = {}
        self.parameters: dict[str, dict] = {}
        for listed, names in ((self.declaration["inputs"], self.ports), (self.declaration["parameters"], self.parameters)):
            for spec in listed:
                mine = python_name(spec["name"], taken)
                names[mine] = spec
                taken.add(mine)
        expected = dict(_native.expectations(name))
        for spec in self.parameters.values():
            spec["expects"] = expected[spec["name"]]

    def signature(self) -> inspect.Signature:
        Parameter = inspect.Parameter
        inputs, has_optional = [], False
        for name, port in self.ports.items():
            has_optional = has_optional or port.get("optional", False)
            default = None if has_optional else Parameter.empty
            inputs.append(Parameter(name, Parameter.POSITIONAL_OR_KEYWORD, default=default))
        named = [
            Parameter(name, Parameter.KEYWORD_ONLY, default=Parameter.empty if spec.get("required") else default_of(spec))
            for name, spec in self.parameters.items()
        ]
        named.sort(key=lambda parameter: parameter.default is not Parameter.empty)
        call = [Parameter(name, Parameter.KEYWORD_ONLY, default=default) for name, (default, _, _) in _CALL.items()]
        return inspect.Signature([*inputs, *named, *call])

    def page(self) -> str:
        """The docstring."""
        declared = self.declaration
        parts = [*textwrap.wrap(declared["summary"], 88), ""]
        if declared.get("source"):
            parts += [*textwrap.wrap(f"Source: {declared['source']}.", 88), ""]
        parts += ["Parameters", "----------"]
        for name, port in self.ports.items():
            kind = kind_text(port)
            parts += entry(name, f"{kind}, optional" if port.get("optional") else kind, self._with_python_names(port["help"]))
        for name, spec in self.parameters.items():
            default = default_of(spec)
            form = f"list of {spec['type']}s" if spec.get("list") else spec["type"]
            form += ", required" if spec.get("required") else ", optional" if default is None else f", default {default!r}"
            text = spec["help"] if spec["type"] == "boolean" else f"{spec['help']} Takes {spec['expects']}."
            for choice in spec.get("choices", []):
                text += f"\n{choice['name']}: {choice['help']}" if choice.get("help") else ""
            parts += entry(name, form, self._with_python_names(text, of_parameter=True))
        for name, (default, form, text) in _CALL.items():
            parts += entry(name, f"{form}, default {default!r}", text)
        first, *others = declared["outputs"]
        parts += ["", "Returns", "-------"]
        parts += entry("", output_text(first), self._with_python_names(first["help"]))
        if others:
            parts += ["", "Other outputs, by name in `outputs` of the result", "-" * 50]
            for port in others:
                parts += entry(port["name"], output_text(port), self._with_python_names(port["help"]))
        if declared["metrics"]:
            parts += ["", "Metrics, in `metrics` of the result", "-" * 35]
            for metric in declared["metrics"]:
                better = {"larger": " Larger is better.", "smaller": " Smaller is better."}.get(metric.get("better"), "")
                parts += entry(metric["name"], metric["unit"], self._with_python_names(metric["help"]) + better)
        parts += ["", "Raises", "------"]
        parts += entry("", "scanmill.Error", "With the reason and what to do.")
        parts += ["", "Notes", "-----"]
        if declared.get("ties"):
            parts += textwrap.wrap(f"Ties: {self._with_python_names(declared['ties'])}", 88)
        if declared.get("not-finite"):
            parts += textwrap.wrap(f"NaN and infinity: {self._with_python_names(declared['not-finite'])}", 88)
        for doubt in declared.get("doubts", []):
            parts += textwrap.wrap(f"The result is doubtful if {self._with_python_names(doubt)}.", 88)
        parts += textwrap.wrap("A length is a text such as '0.2 mm', or a number in the scan's own unit.", 88)
        return "\n".join(parts)

    def _with_python_names(self, text: str, of_parameter: bool = False) -> str:
        """Parameters with hyphens get the names that the function has for them. Metrics and columns keep theirs. If both have
        a name, a quoted one in the help of a parameter is that of the parameter."""
        own = {metric["name"] for metric in self.declaration["metrics"]} | set(self.declaration.get("adds", []))
        for name, spec in self.parameters.items():
            if of_parameter:
                text = text.replace(f"`{spec['name']}`", f"`{name}`")
            if "-" in spec["name"] and spec["name"] not in own:
                text = re.sub(rf"(?<![\w-]){re.escape(spec['name'])}(?![\w-])", name, text)
        return text


def entry(name: str, form: str, text: str) -> list[str]:
    lines = [f"{name} : {form}" if name else form]
    for part in text.split("\n"):
        lines += textwrap.wrap(part, 84, initial_indent="    ", subsequent_indent="    ", break_on_hyphens=False)
    return lines


def class_name(kind: str) -> str:
    return KINDS[kind].__name__ if kind in KINDS else "Value"


def kind_text(port: dict) -> str:
    kinds = " or ".join(class_name(kind) for kind in [port["kind"], *port.get("also", [])])
    return f"list of {kinds}" if port.get("list") else kinds


def output_text(port: dict) -> str:
    return f"the kind of `{port['like']}`" if port.get("like") else class_name(port["kind"])


def default_of(spec: dict) -> Any:
    """The default as Python users write it: numbers and truth values as such, other values as texts."""

    def typed(item: Any) -> Any:
        if not isinstance(item, str) or spec["type"] not in ("boolean", "integer", "number"):
            return item
        if item in ("true", "false"):
            return item == "true"
        try:
            return int(item) if spec["type"] == "integer" else float(item)
        except ValueError:
            return item  # a word: auto

    value = spec.get("default")
    return [typed(item) for item in value] if isinstance(value, list) else typed(value)


def written(name: str, spec: dict, value: Any) -> tuple[list[str], bool]:
    """The value as a workflow has it."""

    def one(item: Any) -> str:
        if isinstance(item, np.generic):
            item = item.item()
        kind = spec["type"]
        if isinstance(item, os.PathLike):
            item = os.fspath(item)
        if isinstance(item, str):
            return os.path.abspath(item) if kind == "path" and item and item != spec.get("word") else item
        if isinstance(item, bool):
            if kind == "boolean" or spec.get("word"):
                return "true" if item else "false"
        elif isinstance(item, (int, float)) and kind in ("integer", "number", "length", "ratio"):
            if kind == "length":
                return f"{item!r} u"
            return repr(item)
        raise TypeError(f"{name} is {item!r}; expected {spec['expects']}")

    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [one(item) for item in value], True
    return [one(value)], False


def _given_inputs(filter_: Filter, given: Mapping[str, Any]) -> list[tuple[str, _native.Value]]:
    inputs = []
    for name, port in filter_.ports.items():
        value = given.get(name)
        if value is None:
            if not port.get("optional"):
                raise TypeError(f"{filter_.function}() needs `{name}`: {kind_text(port)}")
            continue
        items = value if port.get("list") and isinstance(value, (list, tuple)) else [value]
        if not items:
            raise TypeError(f"{filter_.function}() needs at least one value in `{name}`")
        for item in items:
            if isinstance(item, np.ndarray) and "points" in (port["kind"], *port.get("also", [])):
                item = Points(item, copy=True)  # the caller goes on to use the array
            if not isinstance(item, Value) or item.kind not in (port["kind"], *port.get("also", [])):
                raise TypeError(f"{filter_.function}() takes {kind_text(port)} as `{name}`; it was given {_described(item, port)}")
            inputs.append((port["name"], item._native))
    return inputs


def _described(item: Any, port: dict) -> str:
    """What the caller passed; with the output of the same filter that fits, if one does."""
    if not isinstance(item, Value):
        return type(item).__name__
    fitting = [name for name, value in item.outputs.items() if value.kind in (port["kind"], *port.get("also", []))]
    also = f", whose filter also gave one: pass .outputs[{fitting[0]!r}]" if fitting else ""
    return f"{type(item).__name__}{also}"


def _reporter(progress: Any, name: str) -> tuple[Callable[[float], None] | None, Callable[[], None]]:
    """The callback, and what closes its bar."""
    if progress is None or progress is False:
        return None, lambda: None
    if progress is not True:
        return progress, lambda: None
    from ._bar import bar

    return bar(name)


def _require_options(options: Mapping[str, Any]) -> None:
    for name in ("seed", "threads", "memory_limit"):
        value = options[name]
        if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < 0:
            raise TypeError(f"{name} is {value!r}; expected a whole number of at least 0")
    seconds = options["time_limit"]
    if isinstance(seconds, bool) or not isinstance(seconds, (int, float)) or not 0 <= seconds < float("inf"):
        raise TypeError(f"time_limit is {seconds!r}; expected seconds, or 0 for no limit")
    if not isinstance(options["isolated"], bool):
        raise TypeError(f"isolated is {options['isolated']!r}; expected True or False")
    if not (options["progress"] is None or isinstance(options["progress"], bool) or callable(options["progress"])):
        raise TypeError(f"progress is {options['progress']!r}; expected a function of one number, True or None")


def call(filter_: Filter, *args: Any, **kwargs: Any) -> Any:
    names = list(filter_.ports)
    if len(args) > len(names):
        raise TypeError(f"{filter_.function}() takes {len(names)} values by position ({', '.join(names) or 'none'}); it was given {len(args)}")
    given = dict(zip(names, args))
    options = {name: default for name, (default, _, _) in _CALL.items()}
    parameters = []
    for name, value in kwargs.items():
        if name in given:
            raise TypeError(f"{filter_.function}() was given `{name}` twice")
        if name in filter_.ports:
            given[name] = value
        elif name in filter_.parameters:
            spec = filter_.parameters[name]
            if value is not None:
                parameters.append((spec["name"], *written(name, spec, value)))
        elif name in options:
            options[name] = value
        else:
            from difflib import get_close_matches

            known = [*filter_.ports, *filter_.parameters, *options]
            near = get_close_matches(name, known, 1)
            raise TypeError(f"{filter_.function}() has no parameter `{name}`; {f'did you mean `{near[0]}`?' if near else 'it has ' + ', '.join(known)}")
    for name, spec in filter_.parameters.items():
        if spec.get("required") and kwargs.get(name) is None:
            raise TypeError(f"{filter_.function}() needs `{name}`: {spec['expects']}")
    inputs = _given_inputs(filter_, given)
    _require_options(options)
    on_progress, close = _reporter(options["progress"], filter_.name)
    try:
        report = _native.run(
            filter_.name,
            inputs,
            parameters,
            options["seed"],
            options["threads"],
            on_progress,
            program() if options["isolated"] else None,
            options["memory_limit"],
            options["time_limit"],
        )
    finally:
        close()
    made = Made(filter_.name, report)
    if report["error"] is not None:
        error: Error = report["error"]
        error.warnings, error.metrics = made.warnings, made.metrics
        raise error
    result = wrap(report["outputs"][filter_.declaration["outputs"][0]["name"]], made)
    for texts, category in ((made.warnings, ScanmillWarning), (made.doubts, DoubtWarning)):
        for text in texts:
            warning = category(f"{filter_.name}: {text}")
            warning.result = result  # where warnings are errors, the result is not lost
            warnings.warn(warning, stacklevel=3)
    return result


def _function(name: str) -> Callable[..., Any]:
    filter_ = Filter(name)

    def function(*args: Any, **kwargs: Any) -> Any:
        return call(filter_, *args, **kwargs)

    function.__name__ = function.__qualname__ = filter_.function
    function.__module__ = "scanmill"
    function.__doc__ = filter_.page()
    function.__signature__ = filter_.signature()  # type: ignore[attr-defined]
    function.declaration = filter_.declaration  # type: ignore[attr-defined]
    return function


class Filters(Mapping[str, Callable[..., Any]]):
    """The functions of all installed filters, by the filter's name ("alpha-solid") or the function's ("alpha_solid")."""

    def __init__(self) -> None:
        self._functions: dict[str, Callable[..., Any]] = {}

    def __getitem__(self, name: str) -> Callable[..., Any]:
        if not isinstance(name, str):
            raise KeyError(name)
        name = name.replace("_", "-")
        if name not in self._functions:
            if name not in _native.filters():
                reasons = dict(_native.unusable())
                raise KeyError(f"the filter '{name}' cannot be used: {reasons[name]}" if name in reasons else name)
            self._functions[name] = _function(name)
        return self._functions[name]

    def __iter__(self) -> Iterator[str]:
        return iter(_native.filters())

    def __len__(self) -> int:
        return len(_native.filters())

    def __repr__(self) -> str:
        return f"<scanmill.filters: {', '.join(self)}>"


filters = Filters()
