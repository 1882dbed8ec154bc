# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `scanmill`, its modules, workflows and schemas, as a tree below this package."""
import os

#: The folder that contains bin, lib, include and share: CMAKE_PREFIX_PATH of filters that are built against this package.
prefix = os.path.join(os.path.dirname(os.path.abspath(__file__)), "tree")


def __getattr__(name: str) -> str:
    if name == "__version__":
        from importlib.metadata import version  # not at the top: it would slow down every start of the command

        return version("scanmill")
    raise AttributeError(f"module 'scanmill' has no attribute '{name}'")
