# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors and warnings."""
from __future__ import annotations

from typing import Any

#: What the caller can do, by the number of the remedy that an error names. Core and engine do not know Python's names.
_REMEDIES = (
    "",
    "pass the scans as the second argument",
    "pass the files as inputs={'NAME': 'FILE'}",
    "in Python: unit='mm', for read() and for Points and Mesh",
    "in Python: VALUE.in_unit('mm')",
    "in Python: drop the rows with a NaN or infinite coordinate before the call",
    "or drop them: invalid='drop'",
    "in Python: output='FOLDER'",
    "in Python: cache='FOLDER'",
    "in Python: jobs=0",
    "in Python: unit='mm' for the truth",
    "scanmill.apply_transform moves data to another frame",
    "scanmill.sculpt and scanmill.region_grow mesh points",
    "",
    "",
)


class Error(Exception):
    """What was found and what is needed, in one sentence.

    Attributes
    ----------
    sentence : str
    frames : tuple of str
        Where it happened, innermost first.
    hint : str
        What to do; empty if the sentence says it.
    warnings : list of str
        Warnings before the error.
    metrics : Measured
        What the filter measured before the error.
    run : Run
        Of run() and batch(): what the run gave, also for other cells.
    """

    run: Any = None

    def __init__(self, sentence: str, frames: tuple[str, ...] | list[str] = (), hint: str = "", remedy: int = 0):
        super().__init__("\n  ".join([sentence, *frames]))
        self.sentence = sentence
        self.frames = tuple(frames)
        self.hint = "; ".join(part for part in (hint, _REMEDIES[remedy]) if part)
        self.warnings: list[str] = []
        self.metrics: dict[str, float] = {}
        if self.hint:
            self.add_note(f"hint: {self.hint}")

    def __reduce__(self):
        return _error_again, (self.sentence, self.frames, self.hint)


def _error_again(sentence: str, frames: tuple[str, ...], hint: str) -> Error:
    return Error(sentence, frames, hint)


class ScanmillWarning(UserWarning):
    """A valid but remarkable result, or something that was left out. `result` has the result that it is about, if there is one."""

    result: Any = None


class DoubtWarning(ScanmillWarning):
    """The result is probably not what the caller wants."""
