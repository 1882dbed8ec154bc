# SPDX-License-Identifier: GPL-3.0-or-later
"""Scanmill turns 3D scans into surfaces.

Every installed filter is a function: `scanmill.decimate(mesh, max_error="0.1 %diag")` returns the filter's first output.
`help(scanmill.decimate)` describes it, and `scanmill.filters` lists all. `scanmill.read` and `scanmill.write` take files,
`scanmill.run` and `scanmill.batch` run workflows as the command `scanmill` does.
"""
import os
import sys

#: The folder that contains bin, lib, include and share: CMAKE_PREFIX_PATH of filters that are built against this package.
prefix = os.path.join(os.path.dirname(os.path.abspath(__file__)), "tree")

# Names are imported on their first use, because the command, which only starts another program, imports this file, too.
_NAMES = {
    "_errors": ("Error", "ScanmillWarning", "DoubtWarning"),
    "_kinds": ("Value", "Points", "Mesh", "Tets", "Features", "Line", "Patches", "Probes", "Transforms", "Metrics", "Picture", "Measured"),
    "_files": ("read", "write"),
    "_filters": ("filters",),
    "_others": ("to_trimesh", "from_trimesh", "to_open3d", "from_open3d", "to_pyvista"),
    "_runs": ("run", "batch", "Run", "Cell", "Output", "Step"),
}
_MODULE_OF = {name: module for module, names in _NAMES.items() for name in names}


def _imported(module: str):
    """The module. Without what the functions need, says how to get it; the command needs nothing."""
    from importlib import import_module

    if sys.version_info < (3, 11):
        raise ImportError(f"the functions of scanmill need Python 3.11 or newer; this is {sys.version.split()[0]}")
    try:
        return import_module(f"scanmill.{module}")
    except ImportError as error:
        if error.name == "numpy" or "nanobind_backend" in str(error):
            raise ImportError("the functions of scanmill need two more packages: pip install numpy nanobind-backend") from error
        raise


def __getattr__(name: str):
    if name == "__version__":
        from importlib.metadata import PackageNotFoundError, version

        try:
            return version("scanmill")
        except PackageNotFoundError:  # the package of a build folder
            from ._native import version as native

            return native
    if name in _MODULE_OF:
        value = getattr(_imported(_MODULE_OF[name]), name)
    elif name.startswith("_"):
        raise AttributeError(f"module 'scanmill' has no attribute '{name}'")
    else:
        filters = _imported("_filters").filters
        try:
            value = filters[name]
        except KeyError as error:
            from difflib import get_close_matches

            if "cannot be used" in str(error):
                raise AttributeError(error.args[0]) from None

            near = get_close_matches(name, [*_MODULE_OF, *(each.replace("-", "_") for each in filters)], 1)
            raise AttributeError(f"module 'scanmill' has no attribute '{name}'" + (f"; did you mean '{near[0]}'?" if near else "")) from None
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    filters = _imported("_filters").filters
    return sorted({*globals(), *_MODULE_OF, *(name.replace("-", "_") for name in filters)})
