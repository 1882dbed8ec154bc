# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the installed tree is: the program, its modules, workflows and schemas."""
from __future__ import annotations

import os
from pathlib import Path

from . import _native


def program() -> str:
    """The program `scanmill` beside the libraries of this module."""
    libraries = Path(_native.core_library()).parent
    for folder in (libraries.parent, libraries.parent.parent):
        found = folder / "bin" / "scanmill"
        if os.access(found, os.X_OK):
            return str(found)
    raise FileNotFoundError(f"the program scanmill is not beside '{libraries}'; install the package again")
