# SPDX-License-Identifier: GPL-3.0-or-later
"""A progress bar: that of tqdm where it is installed, else a line on stderr."""
from __future__ import annotations

import sys
from collections.abc import Callable


def bar(name: str) -> tuple[Callable[[float], None], Callable[[], None]]:
    """The function that shows a fraction, and the one that ends the bar."""
    if sys.stderr is None:
        return lambda fraction: None, lambda: None
    try:
        from tqdm.auto import tqdm
    except ModuleNotFoundError:
        return _line(name)
    shown = tqdm(total=100, desc=name, unit="%", bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining}")

    def show(fraction: float) -> None:
        shown.update(100 * fraction - shown.n)

    return show, shown.close


def _line(name: str) -> tuple[Callable[[float], None], Callable[[], None]]:
    last = -1

    def show(fraction: float) -> None:
        nonlocal last
        if int(100 * fraction) > last:
            last = int(100 * fraction)
            print(f"\r{name}: {last:3d} %", end="", file=sys.stderr, flush=True)

    return show, lambda: print(file=sys.stderr)
