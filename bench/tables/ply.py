# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes binary PLY files of doubles, and reads the vertices of binary ones."""
import pathlib

import numpy


def write_ply(path, vertices, faces=None):
    """Points, or with `faces` (n × 3 indices) a mesh."""
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}",
              *(f"property double {axis}" for axis in "xyz")]
    if faces is not None:
        header += [f"element face {len(faces)}", "property list uchar int vertex_indices"]
    with open(path, "wb") as file:
        file.write(("\n".join([*header, "end_header"]) + "\n").encode())
        file.write(numpy.ascontiguousarray(vertices, "<f8").tobytes())
        if faces is not None:
            rows = numpy.empty(len(faces), dtype=[("count", "u1"), ("corners", "<i4", 3)])
            rows["count"], rows["corners"] = 3, faces
            file.write(rows.tobytes())


def read_vertices(path):
    """The vertices of a binary little-endian PLY file as a structured array, a field per property."""
    header, body = pathlib.Path(path).read_bytes().split(b"end_header\n", 1)
    lines = header.decode("latin-1").splitlines()
    begin = next(i for i, line in enumerate(lines) if line.startswith("element vertex"))
    types = {"double": "<f8", "float": "<f4", "int": "<i4", "uint": "<u4", "short": "<i2", "ushort": "<u2", "char": "i1",
             "uchar": "u1"}
    fields = []
    for line in lines[begin + 1:]:
        if not line.startswith("property"):
            break
        _, kind, name = line.split()
        fields.append((name, types[kind]))
    return numpy.frombuffer(body, dtype=fields, count=int(lines[begin].split()[2]))
