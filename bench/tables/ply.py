# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes binary PLY files of doubles."""
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
