#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""licences.py FOLDER [PAGE_PACKAGES]: writes into FOLDER the licences of the libraries that are compiled into the program:
those of Debian packages, and those of the packages of the report page, which are below PAGE_PACKAGES (node_modules)."""
import pathlib
import subprocess
import sys

#: Debian packages whose headers, static libraries or font become part of the program. Boost has two megabytes of text for
#: all of its parts; the licence of its headers is in deb/copyright.
COMPILED_IN = (
    "libcgal-dev", "libeigen3-dev", "libcli11-dev", "nlohmann-json3-dev", "libtinygltf-dev",
    "libsqlitecpp-dev", "fonts-dejavu-core",
)
BUNDLED_IN_PAGE = ("three", "uplot")


def copyright_of(package: str) -> str:
    """The text that the Debian package installs; empty if it has none."""
    file = pathlib.Path("/usr/share/doc") / package.partition(":")[0] / "copyright"
    return file.read_text(encoding="utf-8", errors="replace") if file.exists() else ""


def package_of(library: pathlib.Path) -> str:
    """The Debian package that installed the file; empty if none did."""
    for path in (library, library.resolve(), pathlib.Path("/usr") / str(library.resolve()).lstrip("/")):
        found = subprocess.run(["dpkg-query", "-S", str(path)], capture_output=True, text=True, check=False)
        if found.returncode == 0:
            return found.stdout.split(": ")[0].split(",")[0]
    return ""


def write_licences(folder: pathlib.Path, packages: list[str]) -> list[str]:
    """Writes PACKAGE.txt for each package, and returns the packages that have no text."""
    folder.mkdir(parents=True, exist_ok=True)
    missing = []
    for package in packages:
        text = copyright_of(package)
        if text:
            (folder / f"{package.partition(':')[0]}.txt").write_text(text, encoding="utf-8")
        else:
            missing.append(package)
    return missing


def main() -> None:
    if not 2 <= len(sys.argv) <= 3:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    missing = write_licences(folder, list(COMPILED_IN))
    if len(sys.argv) == 3:
        for name in BUNDLED_IN_PAGE:
            licence = pathlib.Path(sys.argv[2]) / name / "LICENSE"
            if licence.exists():
                (folder / f"{name}.txt").write_text(licence.read_text(encoding="utf-8"), encoding="utf-8")
            else:
                missing.append(name)
    if missing:
        print(f"warning: no licence was found for {', '.join(missing)}", file=sys.stderr)


if __name__ == "__main__":
    main()
