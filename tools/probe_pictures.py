# SPDX-License-Identifier: GPL-3.0-or-later
"""Picture of the probe planner: a section across an edge."""
import math

from drawing import BRIGHT, INK, PALE, SOLID, Picture

EDGE = (3.4, 1.4)
ALPHA, RADIUS, ERROR = math.radians(80), 0.85, 0.3


def at(distance, phi):
    """Seen from the edge, in a direction phi from the bisector, positive to the left."""
    return EDGE[0] - distance * math.sin(phi), EDGE[1] + distance * math.cos(phi)


def probe_planner():
    picture = Picture(6.8, 5)
    half = math.acos(ERROR / RADIUS) - ALPHA / 2
    picture.polygon([at(2.6, math.pi - ALPHA / 2), EDGE, at(2.6, math.pi + ALPHA / 2)], SOLID, INK, 1.5)
    sector = [EDGE] + [at(2.9, half * (i / 12 - 1)) for i in range(25)]
    picture.polygon(sector, "#f6dfe3", "#f6dfe3")
    picture.circle(EDGE, ERROR, PALE, "none", "4 3")
    for i in range(14):
        turn, far = 2.4 * i, ERROR * math.sqrt((i + 0.5) / 14)
        picture.dot((EDGE[0] + far * math.cos(turn), EDGE[1] + far * math.sin(turn)), PALE, 2)
    centre = at(RADIUS, 0)
    picture.line(at(3.2, 0), centre, INK, 1, "3 4")
    picture.circle(at(2.5, 0), RADIUS * 0.999, PALE, "none", "5 4")
    picture.arrow(at(2.5, 0), at(1.8, 0), BRIGHT)
    picture.circle(centre, RADIUS, BRIGHT)
    picture.dot(centre, BRIGHT, 3)
    picture.dot(EDGE, INK, 4)
    for phi, words in ((half, "φ max"), (-half, "−φ max")):
        x, y = at(3.0, phi)
        picture.text((x - (0.75 if phi > 0 else -0.08), y), words)
    for side, words in ((1, "n1"), (-1, "n2")):
        foot = at(1.5, math.pi - side * ALPHA / 2)
        normal = at(0.6, side * (math.pi / 2 - ALPHA / 2))
        tip = (foot[0] + normal[0] - EDGE[0], foot[1] + normal[1] - EDGE[1])
        picture.arrow(foot, tip)
        picture.text((tip[0] - (0.3 if side > 0 else -0.08), tip[1]), words)
    return picture
