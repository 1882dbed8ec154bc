# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads PLY meshes and draws points, triangles and lines into PNG files, with depth and shading. Needs no package."""
import math
import struct
import zlib

#: Samples per pixel and direction.
FINE = 2
LIGHT = (0.35, 0.45, 0.82)
#: What is at least left of a colour in the shadow.
SHADOW = 0.25

TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}


def read_ply(path):
    """Elements by name: a list of rows for each, which are dictionaries. Binary, little endian, as we write it."""
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    elements = []
    for line in data[:end].decode("ascii", "replace").splitlines():
        words = line.split()
        if words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(words[1:])
    at, found = end, {}
    for name, count, properties in elements:
        rows = []
        for _ in range(count):
            row = {}
            for words in properties:
                if words[0] == "list":
                    size, = struct.unpack_from("<" + TYPES[words[1]], data, at)
                    at += struct.calcsize(TYPES[words[1]])
                    layout = f"<{size}{TYPES[words[2]]}"
                    row[words[3]] = struct.unpack_from(layout, data, at)
                    at += struct.calcsize(layout)
                else:
                    row[words[1]], = struct.unpack_from("<" + TYPES[words[0]], data, at)
                    at += struct.calcsize(TYPES[words[0]])
            rows.append(row)
        found[name] = rows
    return found


def corners(row):
    return row.get("vertex_indices") or row["vertex_index"]


def position(row):
    return row["x"], row["y"], row["z"]


def minus(p, q):
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


def dot(p, q):
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


def cross(p, q):
    return p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]


def unit(p):
    length = math.sqrt(dot(p, p)) or 1.0
    return p[0] / length, p[1] / length, p[2] / length


class View:
    """A picture of things near a cloud of points, seen from `towards`, with `up` upwards; parallel lines stay parallel."""

    def __init__(self, points, towards, up, size=400):
        self.size = size * FINE
        self.forward = unit(towards)
        self.right = unit(cross(up, self.forward))
        self.up = cross(self.forward, self.right)
        seen = [(dot(p, self.right), dot(p, self.up)) for p in points]
        low = [min(s[i] for s in seen) for i in (0, 1)]
        high = [max(s[i] for s in seen) for i in (0, 1)]
        self.centre = [(low[i] + high[i]) / 2 for i in (0, 1)]
        self.scale = 0.94 * self.size / max(high[i] - low[i] for i in (0, 1))
        self.colours = [(255, 255, 255)] * (self.size * self.size)
        self.depths = [-math.inf] * (self.size * self.size)

    def place(self, p):
        """Column, row, and depth, which grows towards the eye."""
        return (self.size / 2 + (dot(p, self.right) - self.centre[0]) * self.scale,
                self.size / 2 - (dot(p, self.up) - self.centre[1]) * self.scale, dot(p, self.forward) * self.scale)

    def shade(self, colour, normal):
        light = abs(dot(normal, self.forward)) * LIGHT[2] + dot(normal, self.up) * LIGHT[1] + \
            dot(normal, self.right) * LIGHT[0]
        strength = SHADOW + (1 - SHADOW) * min(1.0, max(0.0, light))
        return tuple(int(part * strength) for part in colour)

    def put(self, column, row, depth, colour):
        if 0 <= column < self.size and 0 <= row < self.size and depth > self.depths[row * self.size + column]:
            self.depths[row * self.size + column] = depth
            self.colours[row * self.size + column] = colour

    def point(self, p, colour, radius=1):
        column, row, depth = self.place(p)
        for i in range(-radius, radius + 1):
            for j in range(-radius, radius + 1):
                if i * i + j * j <= radius * radius:
                    self.put(round(column) + i, round(row) + j, depth, colour)

    def triangle(self, a, b, c, colour, normals=None):
        """With the colour as it is without `normals`; else shaded, with the normals of the corners."""
        (x0, y0, z0), (x1, y1, z1), (x2, y2, z2) = self.place(a), self.place(b), self.place(c)
        area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        if area == 0:
            return
        for row in range(math.ceil(min(y0, y1, y2)), math.floor(max(y0, y1, y2)) + 1):
            for column in range(math.ceil(min(x0, x1, x2)), math.floor(max(x0, x1, x2)) + 1):
                u = ((column - x0) * (y2 - y0) - (x2 - x0) * (row - y0)) / area
                v = ((x1 - x0) * (row - y0) - (column - x0) * (y1 - y0)) / area
                if u < 0 or v < 0 or u + v > 1:
                    continue
                w = 1 - u - v
                shaded = colour
                if normals:
                    n = [w * normals[0][i] + u * normals[1][i] + v * normals[2][i] for i in range(3)]
                    shaded = self.shade(colour, unit(n))
                self.put(column, row, w * z0 + u * z1 + v * z2, shaded)

    def line(self, a, b, colour, nearer=1.5):
        """Drawn so many samples nearer to the eye than it is, so that a surface that it lies on does not hide it."""
        (x0, y0, z0), (x1, y1, z1) = self.place(a), self.place(b)
        steps = max(1, math.ceil(max(abs(x1 - x0), abs(y1 - y0))))
        for i in range(steps + 1):
            t = i / steps
            self.put(round(x0 + t * (x1 - x0)), round(y0 + t * (y1 - y0)), z0 + t * (z1 - z0) + nearer, colour)

    def write(self, path):
        width = self.size // FINE
        rows = bytearray()
        for y in range(width):
            rows.append(0)
            for x in range(width):
                some = [self.colours[(FINE * y + j) * self.size + FINE * x + i] for j in range(FINE)
                        for i in range(FINE)]
                rows += bytes(sum(one[k] for one in some) // len(some) for k in range(3))

        def chunk(name, content):
            return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))

        with open(path, "wb") as file:
            file.write(b"\x89PNG\r\n\x1a\n")
            file.write(chunk(b"IHDR", struct.pack(">IIBBBBB", width, width, 8, 2, 0, 0, 0)))
            file.write(chunk(b"IDAT", zlib.compress(bytes(rows), 9)) + chunk(b"IEND", b""))
