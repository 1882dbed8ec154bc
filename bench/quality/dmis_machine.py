# SPDX-License-Identifier: GPL-3.0-or-later
"""A coordinate measuring machine that runs the DMIS program of a plan on a mesh, and the time that it takes."""
import re
from dataclasses import dataclass, field

import numpy
import open3d

#: Model of the time: straight moves at this speed (mm/s), each with a stop (s); the approach of a touch is slower, and after the
#: contact the ball backs off. These are the specified speeds of a bridge machine with a touch-trigger probe.
MOVE_SPEED, STOP, TOUCH_SPEED, SETTLE = 100.0, 0.3, 8.0, 0.5
#: Sphere tracing ends at this share of the radius.
CONTACT = 1e-6
STEPS = 200
TOUCHES_AT_ONCE = 10_000


@dataclass
class Program:
    """The statements that matter, in their order. Lengths in the program's unit."""

    unit: str = ""
    radius: float = 0.0
    approach: float = 0.0
    search: float = 0.0
    labels: list = field(default_factory=list)
    points: list = field(default_factory=list)
    directions: list = field(default_factory=list)
    #: For each touch, the ball's centre before it.
    starts: list = field(default_factory=list)
    #: Length and number of the moves between touches.
    travel: float = 0.0
    moves: int = 0


def statements(text):
    """The statements of a DMIS file, with continued lines joined; no comments."""
    joined = re.sub(r"\$\n", "", text)
    return [line.strip() for line in joined.splitlines() if line.strip() and not line.startswith("$$")]


def numbers(words):
    return numpy.array([float(word) for word in words.split(",")])


def read_program(file):
    """Raises ValueError where a touch has no start or measures another feature than it defines."""
    program, position, label = Program(), None, None
    for statement in statements(file.read_text(encoding="ascii")):
        if found := re.fullmatch(r"UNITS/(\w+),ANGDEC", statement):
            program.unit = found[1]
        elif found := re.match(r"S\(TIP1\)=SNSDEF/.*,([0-9.]+)$", statement):
            program.radius = float(found[1]) / 2
        elif found := re.fullmatch(r"SNSET/(APPRCH|SEARCH),([0-9.]+)", statement):
            setattr(program, {"APPRCH": "approach", "SEARCH": "search"}[found[1]], float(found[2]))
        elif found := re.fullmatch(r"GOTO/(?:CART,)?(.*)", statement):
            to = numbers(found[1])
            if position is not None:
                program.travel += float(numpy.linalg.norm(to - position))
                program.moves += 1
            position = to
        elif found := re.fullmatch(r"F\((\w+)\)=FEAT/POINT,CART,.*", statement):
            label = found[1]
        elif found := re.fullmatch(r"MEAS/POINT,F\((\w+)\),1", statement):
            if found[1] != label:
                raise ValueError(f"{file.name}: {found[1]} is measured before it is defined")
        elif found := re.fullmatch(r"PTMEAS/CART,(.*)", statement):
            if position is None:
                raise ValueError(f"{file.name}: {label} is touched from nowhere")
            values = numbers(found[1])
            program.labels.append(label)
            program.points.append(values[:3])
            program.directions.append(values[3:] / numpy.linalg.norm(values[3:]))
            program.starts.append(position)
    return program


def seconds(program):
    """By the model above, for all touches and the moves between them."""
    reach = numpy.linalg.norm(numpy.array(program.starts) - numpy.array(program.points), axis=1) - program.radius
    touching = 2 * float(reach.sum()) / TOUCH_SPEED + SETTLE * len(program.labels)
    return program.travel / MOVE_SPEED + STOP * program.moves + touching


def contacts(program, vertices, faces):
    """Whether the ball met the mesh, and its centre then, for every touch. It moves from its start towards the touched point,
    at most by the radius and half of the search distance farther."""
    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(open3d.core.Tensor(vertices.astype("f4")), open3d.core.Tensor(faces.astype("u4")))
    starts, away = numpy.array(program.starts), numpy.array(program.directions)
    last = numpy.linalg.norm(starts - numpy.array(program.points), axis=1) + program.search / 2
    moved, met = numpy.zeros(len(starts)), numpy.zeros(len(starts), bool)
    corners = vertices[faces]
    for begin in range(0, len(starts), TOUCHES_AT_ONCE):
        rows = numpy.arange(begin, min(begin + TOUCHES_AT_ONCE, len(starts)))
        for _ in range(STEPS):
            centres = starts[rows] - moved[rows, None] * away[rows]
            closest = scene.compute_closest_points(open3d.core.Tensor(centres.astype("f4")))
            triangles = closest["primitive_ids"].numpy().astype(int)
            gap = numpy.linalg.norm(centres - closest_points(centres, corners[triangles]), axis=1) - program.radius
            met[rows[gap <= CONTACT * program.radius]] = True
            moved[rows] += numpy.maximum(gap, 0)
            rows = rows[(gap > CONTACT * program.radius) & (moved[rows] <= last[rows])]
            if not len(rows):
                break
    return met, starts - moved[:, None] * away


def closest_points(points, corners):
    """The point of each triangle (n × 3 × 3) that is nearest to each point, in double precision (Ericson 2005, 5.1.5)."""
    best, least = None, numpy.full(len(points), numpy.inf)
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = numpy.cross(b - a, c - a)
    normal /= numpy.linalg.norm(normal, axis=1)[:, None]
    foot = points - numpy.einsum("ij,ij->i", points - a, normal)[:, None] * normal
    inside = numpy.ones(len(points), bool)
    best = numpy.array(foot)
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        inside &= numpy.einsum("ij,ij->i", numpy.cross(along, foot - start), normal) >= 0
        share = numpy.clip(numpy.einsum("ij,ij->i", points - start, along) / numpy.einsum("ij,ij->i", along, along), 0, 1)
        candidate = start + share[:, None] * along
        distance = numpy.linalg.norm(points - candidate, axis=1)
        best = numpy.where((distance < least)[:, None], candidate, best)
        least = numpy.minimum(least, distance)
    return numpy.where(inside[:, None], foot, best)


def write_results(file, program, met, centres, noise, seed):
    """Measured points as a machine reports them: the centre with an error of deviation `noise` in each coordinate, moved by the
    radius against the approach. Touches that missed the part are left out."""
    errors = numpy.random.default_rng(seed).normal(scale=noise, size=centres.shape)
    away = numpy.array(program.directions)
    points = centres + errors - program.radius * away
    lines = ["DMISMN/'RESULTS',05.2", f"UNITS/{program.unit},ANGDEC"]
    for row in numpy.flatnonzero(met):
        position, direction = (",".join(f"{value:.6f}" for value in values) for values in (points[row], away[row]))
        lines += [f"FA({program.labels[row]})=FEAT/POINT,CART,{position},$", direction]
    file.write_text("\n".join([*lines, "ENDFIL"]) + "\n", encoding="ascii")
