# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs workflows and batches with the program, and gives its records as objects."""
from __future__ import annotations

import json
import os
import signal
import subprocess
import tempfile
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Any

from . import _native
from ._errors import DoubtWarning, Error, ScanmillWarning
from ._files import read
from ._kinds import Value
from ._program import program

#: Seconds that an interrupted run has to stop in an orderly way.
_PATIENCE = 3


@dataclass
class Output:
    """A file that a cell wrote, or should have written."""

    file: Path
    kind: str
    outcome: str
    properties: dict[str, Any] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)

    def read(self) -> Any:
        """The value in the file."""
        return read(self.file)


@dataclass
class Step:
    """A step on one scan. Cells may share it."""

    name: str
    filter: str
    outcome: str
    origin: str
    seconds: float
    metrics: dict[str, Any] = field(default_factory=dict)
    parameters: dict[str, str] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    doubts: list[str] = field(default_factory=list)
    error: str = ""


@dataclass
class Cell:
    """One variant of one workflow on one scan."""

    scan: str
    workflow: str
    variant: str
    outcome: str  # "ok", "doubtful", "failed" or "skipped"
    seconds: float
    outputs: list[Output] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    doubts: list[str] = field(default_factory=list)
    error: str = ""

    @property
    def metrics(self) -> dict[str, Any]:
        """What all steps measured: "step.metric" to number."""
        return {f"{step.name}.{name}": value for step in self.steps for name, value in step.metrics.items()}


@dataclass
class Run:
    """What a run or a batch gave."""

    name: str
    folder: Path
    cells: list[Cell]
    number: int = 0  # number of the run in the records; 0 if it is not recorded
    interrupted: bool = False
    verdict: dict[str, Any] | None = None  # of a batch with a gate or an accepted run
    exit_code: int = 0

    @property
    def ok(self) -> bool:
        """Whether the command would exit with 0."""
        return self.exit_code == 0

    def table(self) -> list[dict[str, Any]]:
        """One dict per cell, as pandas.DataFrame takes them: scan, workflow, variant, outcome, seconds, error, metrics."""
        return [
            {
                "scan": cell.scan,
                "workflow": cell.workflow,
                "variant": cell.variant,
                "outcome": cell.outcome,
                "seconds": cell.seconds,
                "error": cell.error,
                **cell.metrics,
            }
            for cell in self.cells
        ]

    def __len__(self) -> int:
        return len(self.cells)

    def __iter__(self) -> Iterator[Cell]:
        return iter(self.cells)

    def __repr__(self) -> str:
        outcomes = [cell.outcome for cell in self.cells]
        counts = ", ".join(f"{outcomes.count(name)} {name}" for name in ("ok", "doubtful", "failed", "skipped") if name in outcomes)
        return f"<scanmill.Run: {self.name}, {counts or 'no cells'}, in '{self.folder}'>"

    def _repr_html_(self) -> str:
        head = ("scan", "variant", "outcome", "seconds", "files")
        rows = [(cell.scan, cell.variant, cell.outcome, f"{cell.seconds:.2f}", ", ".join(output.file.name for output in cell.outputs)) for cell in self.cells]
        cells = "".join("<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>" for row in rows)
        return "<table><tr>" + "".join(f"<th>{name}</th>" for name in head) + f"</tr>{cells}</table>"


def run(
    workflow: str | os.PathLike | Mapping[str, Any],
    scans: Any = (),
    *,
    inputs: Mapping[str, Any] | None = None,
    parameters: Mapping[str, Any] | None = None,
    unit: str | None = None,
    invalid: str | None = None,
    only: str | Iterable[str] = (),
    until: str | None = None,
    save: str | Iterable[str] = (),
    picture: bool = False,
    output: str | os.PathLike = "scanmill-out",
    jobs: int | None = None,
    threads: int = 0,
    seed: int = 0,
    cache: str | os.PathLike | bool = True,
    strict: bool = False,
    check: bool = True,
    progress: Callable[[float], None] | bool | None = None,
    on_event: Callable[[dict[str, Any]], None] | None = None,
) -> Run:
    """Runs a workflow over one scan or many, as the command `scanmill run` does.

    Parameters
    ----------
    workflow
        A file, the name of a ready workflow ("raw-scans"), YAML text, or a dict of the same form.
    scans
        One or more files or values for the workflow's first input.
    inputs : dict, optional
        Name of an input to a file, a value, or a list of them.
    parameters : dict, optional
        Values of the workflow's parameters: a text with its unit ("0.2 mm"), a number, a truth value, or a list.
    unit, invalid, only, until, save, picture, output, jobs, threads, seed, strict
        As the options of the command: see `scanmill run --help`.
    cache
        A folder; True for the user's own cache; False computes everything and stores nothing.
    check : bool
        Raise Error if a cell failed. The error has the run as `run`.
    progress
        Called with the fraction of the steps that are done. True shows a bar.
    on_event
        Called with every event of the run, a dict: see `scanmill run --events`.

    Returns
    -------
    Run
    """
    name, text = _workflow(workflow, "workflow")
    words = ["run", name, *_files(scans, Path(output), "scan")]
    for name, values in (inputs or {}).items():
        files = _files(values, Path(output), name)
        if any("," in file for file in files):
            raise ValueError(f"a file of the input '{name}' has a comma in its name, which separates files: {files}")
        words += ["--in", f"{name}={','.join(files)}"]
    for name, value in (parameters or {}).items():
        words += ["--set", f"{name}={_text(value)}"]
    for option, value in (("--unit", unit), ("--invalid", invalid), ("--until", until)):
        words += [option, value] if value else []
    words += _repeated(("--only", only), ("--save", save))
    words += ["--picture"] if picture else []
    words += ["--events", *_common(output, jobs, threads, seed, cache, strict)]
    return _execute(words, text, output, check, progress, on_event)


def batch(
    file: str | os.PathLike | Mapping[str, Any],
    *,
    scans: str | Iterable[str] = (),
    workflows: str | Iterable[str] = (),
    only: str | Iterable[str] = (),
    output: str | os.PathLike = "scanmill-out",
    jobs: int | None = None,
    threads: int = 0,
    seed: int = 0,
    cache: str | os.PathLike | bool = True,
    strict: bool = False,
    check: bool = False,
    progress: Callable[[float], None] | bool | None = None,
    on_event: Callable[[dict[str, Any]], None] | None = None,
) -> Run:
    """Runs workflows over a library of scans, as the command `scanmill batch` does.

    `file` is a batch file, the name of a ready one, its text, or a dict of the same form, whose paths then count from the
    working folder. `scans`, `workflows` and `only` run a part of it. Failed cells raise no error unless `check` is true:
    see Run.ok and Run.verdict. The other parameters are those of run().
    """
    name, text = _workflow(file, "batch")
    words = ["batch", name, *_repeated(("--scan", scans), ("--workflow", workflows), ("--only", only))]
    words += ["--json", *_common(output, jobs, threads, seed, cache, strict)]
    return _execute(words, text, output, check, progress, on_event)


def _common(output: Any, jobs: int | None, threads: int, seed: int, cache: Any, strict: bool) -> list[str]:
    words = ["-q", "--stop-with-parent", "-o", os.fspath(output), "--threads", str(threads), "--seed", str(seed)]
    words += ["-j", str(jobs)] if jobs is not None else []
    words += ["--no-cache"] if cache is False else [] if cache is True else ["--cache", os.fspath(cache)]
    return words + (["--strict"] if strict else [])


def _repeated(*options: tuple[str, Any]) -> list[str]:
    """The words of options that may be given several times: one value, or some."""
    words = []
    for option, values in options:
        for value in [values] if isinstance(values, (str, os.PathLike)) else values:
            words += [option, os.fspath(value)]
    return words


def _workflow(given: Any, noun: str) -> tuple[str, str | None]:
    """The argument of the command, and the text for its standard input if the workflow or batch is not a file."""
    if isinstance(given, os.PathLike) or (isinstance(given, str) and "\n" not in given):
        return _plain(os.fspath(given)), None
    if isinstance(given, str):
        return "-", given
    if isinstance(given, Mapping):
        named = given if noun == "workflow" else {"batch": noun, **given}
        return "-", json.dumps(named, indent=1, default=_number)
    raise TypeError(f"the {noun} is {type(given).__name__}; expected a file, a name, a text or a dict")


def _number(value: Any) -> Any:
    """Numbers and arrays of NumPy, and paths, as JSON has them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{value!r} has no form in a workflow")


def _plain(file: str) -> str:
    """The file's name, which must not look like an option."""
    return f"./{file}" if file.startswith("-") else file


def _files(given: Any, output: Path, name: str) -> list[str]:
    """The names of files. Values are written to the folder `inputs` of the output folder. Their names do not depend on the run,
    so that runs can be compared."""
    items = [given] if isinstance(given, (str, os.PathLike, Value)) else given
    if not isinstance(items, Iterable):
        raise TypeError(f"'{name}' is {type(given).__name__}; expected a file or a value such as Points")
    files: list[str] = []
    items = list(items)
    for item in items:
        if isinstance(item, Value):
            extension = "ply" if item.kind in ("points", "mesh") else "json"
            if not _native.can_write(extension, item.kind):
                raise TypeError(f"a workflow cannot take {type(item).__name__} as '{name}'")
            file = output / "inputs" / f"{name}{'' if len(items) == 1 else f'-{len(files) + 1}'}.{extension}"
            file.parent.mkdir(parents=True, exist_ok=True)
            item.write(file)
            files.append(_plain(str(file)))
        elif isinstance(item, (str, os.PathLike)):
            files.append(_plain(os.fspath(item)))
        else:
            raise TypeError(f"'{name}' is {type(item).__name__}; expected a file or a value such as Points")
    return files


def _text(value: Any) -> str:
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_text(item) for item in value) + "]"
    return str(value).lower() if isinstance(value, bool) else str(value)


def _error(document: Mapping[str, Any]) -> Error:
    """The error that the program printed."""
    if "error" in document:
        error = document["error"]
        return Error(error["message"], error.get("where", ()), error.get("hint", ""))
    lines = [
        f"{file['file']}:{found['line']}:{found['column']}: {found['message']}"
        for file in document["files"]
        for found in file["diagnostics"]
        if found["severity"] == "error"
    ]
    return Error(lines[0]) if len(lines) == 1 else Error(f"{len(lines)} errors", lines)


class _Collector:
    """Makes a Run of events."""

    def __init__(self, folder: Any):
        self.run = Run("", Path(folder), [])
        self.steps: dict[int, Step] = {}
        self.total = 0
        self.percents: dict[int, int] = {}
        self.error: Error | None = None
        self.has_ended = False

    def fraction(self) -> float:
        return min(1.0, sum(self.percents.values()) / (100 * self.total)) if self.total else 0.0

    def take(self, event: Mapping[str, Any]) -> None:
        name = event.get("event")
        if name is None:
            self.error = _error(event)
        elif name == "run-started":
            self.run.name, self.run.number, self.total = event["name"], event.get("run", 0), event["steps"]
        elif name == "step-progress":
            self.percents[event["node"]] = event["percent"]
        elif name == "step-ended":
            self.percents[event["node"]] = 100
            self.steps[event["node"]] = Step(
                event["step"],
                event.get("filter", ""),
                event["outcome"],
                event["origin"],
                event["seconds"],
                event.get("metrics", {}),
                event.get("resolved", event.get("authored", {})),
                event.get("warnings", []),
                event.get("doubts", []),
                event.get("error", ""),
            )
        elif name == "cell-ended":
            outputs = [
                Output(Path(each["file"]), each["kind"], each["outcome"], each.get("properties", {}), each.get("warnings", []))
                for each in event["outputs"]
            ]
            self.run.cells.append(
                Cell(
                    event["scan"],
                    event["workflow"],
                    event["variant"],
                    event["outcome"],
                    event["seconds"],
                    outputs,
                    [self.steps[node] for node in event["steps"] if node in self.steps],
                    event.get("doubts", []),
                    event.get("error", ""),
                )
            )
        elif name == "verdict":
            self.run.verdict = {key: value for key, value in event.items() if key not in ("event", "at")}
        elif name == "run-ended":
            self.run.interrupted = event["interrupted"]
            self.has_ended = True


def _execute(words: list[str], text: str | None, folder: Any, check: bool, progress: Any, on_event: Any) -> Run:
    collector, shown = _Collector(folder), -1.0
    if progress is True:
        from ._bar import bar

        progress, close = bar(words[0])
    else:
        close = None
    try:
        with tempfile.TemporaryFile() as given, tempfile.TemporaryFile() as errors:
            given.write((text or "").encode())
            given.seek(0)
            # A session of its own, so that Ctrl-C reaches the program once, from here.
            process = subprocess.Popen(
                [program(), *words], stdin=given, stdout=subprocess.PIPE, stderr=errors, start_new_session=True
            )
            assert process.stdout
            try:
                for line in process.stdout:
                    event = json.loads(line)
                    collector.take(event)
                    if on_event:
                        on_event(event)
                    if progress and collector.fraction() != shown:
                        progress(shown := collector.fraction())
                code = process.wait()
            except BaseException:
                _stop(process)
                raise
            finally:
                process.stdout.close()
            errors.seek(0)
            printed = errors.read().decode("utf-8", "replace").strip()
    finally:
        if close:
            close()
    result = collector.run
    result.exit_code = code
    if code == 130:
        raise KeyboardInterrupt
    if not collector.has_ended:
        raise collector.error or (_printed_error(printed) if printed else Error(f"the program ended with code {code}"))
    failed = [cell for cell in result.cells if cell.outcome == "failed"]
    if check and failed:
        error = _printed_error(failed[0].error)
        if len(failed) > 1:
            error = Error(f"{error.sentence}; {len(failed) - 1} more of {len(result.cells)} cells failed", error.frames, error.hint)
        error.run = result
        raise error
    _warn(collector, printed)
    return result


def _printed_error(printed: str) -> Error:
    """The error in a text of the program: a sentence, frames and a hint, a line each."""
    sentence, *lines = printed.removeprefix("error: ").split("\n")
    hint = next((line.removeprefix("hint: ") for line in lines if line.startswith("hint: ")), "")
    return Error(sentence, [line.strip() for line in lines if not line.startswith("hint: ")], hint)


def _stop(process: subprocess.Popen) -> None:
    """Lets the run stop in an orderly way. Kills it if that takes too long, or if the caller does not wait for it."""
    process.send_signal(signal.SIGINT)
    try:
        process.communicate(timeout=_PATIENCE)
    except BaseException as error:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        if not isinstance(error, subprocess.TimeoutExpired):
            raise


def _warn(collector: _Collector, printed: str) -> None:
    """Warns of what the program, the steps, the files and the cells report: each sentence once."""
    seen: set[str] = set()

    def warn(sentence: str, category: type[ScanmillWarning]) -> None:
        if sentence not in seen:
            seen.add(sentence)
            warning = category(sentence)
            warning.result = collector.run  # where warnings are errors, the result is not lost
            warnings.warn(warning, stacklevel=5)

    for step in collector.steps.values():
        seen.update(step.warnings)
        for sentence in step.warnings:
            warn(f"{step.name}: {sentence}", ScanmillWarning)
    for cell in collector.run.cells:
        for output in cell.outputs:
            for sentence in output.warnings:
                warn(sentence, ScanmillWarning)
        for doubt in cell.doubts:
            warn(f"{cell.scan}, {cell.variant}: {doubt}", DoubtWarning)
    for line in printed.split("\n"):
        if line.startswith("warning: ") and not any(line.endswith(sentence) for sentence in seen):
            warn(line.removeprefix("warning: "), ScanmillWarning)
