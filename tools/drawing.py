# SPDX-License-Identifier: GPL-3.0-or-later
"""An SVG drawing and the colours of all pictures."""
import math

INK, PALE, BRIGHT, SOLID = "#333333", "#b8b8b8", "#d1495b", "#cfe3ee"


class Picture:
    """An SVG drawing in its own units, with y upwards."""

    def __init__(self, width, height, scale=60):
        self.width, self.height, self.scale = width, height, scale
        self.rows = []

    def place(self, p):
        return round(p[0] * self.scale, 1), round((self.height - p[1]) * self.scale, 1)

    def add(self, row):
        self.rows.append("  " + row)

    def dot(self, p, colour=INK, radius=4, hollow=False):
        x, y = self.place(p)
        fill = f'fill="white" stroke="{colour}" stroke-width="1.5"' if hollow else f'fill="{colour}"'
        self.add(f'<circle cx="{x}" cy="{y}" r="{radius}" {fill}/>')

    def circle(self, centre, radius, colour=INK, fill="none", dash=""):
        x, y = self.place(centre)
        self.add(
            f'<circle cx="{x}" cy="{y}" r="{round(radius * self.scale, 1)}" fill="{fill}" stroke="{colour}"'
            f' stroke-width="1.5"{dash and f" stroke-dasharray={chr(34)}{dash}{chr(34)}"}/>'
        )

    def line(self, p, q, colour=INK, width=1, dash=""):
        (x, y), (u, v) = self.place(p), self.place(q)
        self.add(
            f'<line x1="{x}" y1="{y}" x2="{u}" y2="{v}" stroke="{colour}" stroke-width="{width}"'
            f'{dash and f" stroke-dasharray={chr(34)}{dash}{chr(34)}"}/>'
        )

    def polygon(self, corners, fill, colour=PALE, width=1):
        places = " ".join("{},{}".format(*self.place(p)) for p in corners)
        self.add(f'<polygon points="{places}" fill="{fill}" stroke="{colour}" stroke-width="{width}"/>')

    def cross(self, p, size=0.06, colour=PALE):
        self.line((p[0] - size, p[1]), (p[0] + size, p[1]), colour)
        self.line((p[0], p[1] - size), (p[0], p[1] + size), colour)

    def text(self, p, words, colour=INK):
        x, y = self.place(p)
        self.add(f'<text x="{x}" y="{y}" font-family="sans-serif" font-size="15" fill="{colour}">{words}</text>')

    def arrow(self, p, q, colour=INK):
        self.line(p, q, colour, 1.5)
        turn = math.atan2(q[1] - p[1], q[0] - p[0])
        for side in (2.7, -2.7):
            self.line(q, (q[0] + 0.15 * math.cos(turn + side), q[1] + 0.15 * math.sin(turn + side)), colour, 1.5)

    def write(self, path):
        width, height = round(self.width * self.scale), round(self.height * self.scale)
        head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">\n'
        ground = f'  <rect width="{width}" height="{height}" fill="white"/>\n'
        path.write_text(head + ground + "\n".join(self.rows) + "\n</svg>\n")
