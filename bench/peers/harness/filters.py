# SPDX-License-Identifier: GPL-3.0-or-later
"""The present versions of the filters, from their pages, and rows that measured older ones."""
import pathlib
import re

PAGES = pathlib.Path(__file__).resolve().parents[3] / "filters"


def version(name, pages=PAGES):
    """The number on the filter's page. Raises KeyError without such a page."""
    page = pathlib.Path(pages) / name.replace("-", "_") / "README.md"
    found = re.search(r"^- Version (\d+)\.$", page.read_text(), re.MULTILINE) if page.exists() else None
    if not found:
        raise KeyError(f"{page} does not show the version of a filter")
    return int(found.group(1))


def outdated(row):
    """One text per filter whose version has changed since `row` was measured: "decimate 3, now 4"."""
    changed = []
    for name, measured in sorted(row["filters"].items()):
        try:
            now = version(name)
        except KeyError:
            changed.append(f"{name} {measured}, now removed")
            continue
        if now != measured:
            changed.append(f"{name} {measured}, now {now}")
    return changed
