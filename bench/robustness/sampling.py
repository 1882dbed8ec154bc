# SPDX-License-Identifier: GPL-3.0-or-later
"""Points on a mesh that keep their distance and leave no gap: what a careful scan looks like before noise."""
import numpy
from scipy.spatial import cKDTree

#: How many places are tried for every point that was asked for. Gaps are then rarely beyond 1.2 spacings.
TRIED = 20
#: Points per spacing², of points that keep their distance and leave no gap; counted on large samples.
PER_SQUARE = 0.61


def areas(shape):
    a, b, c = (shape.vertices[shape.triangles[:, i]] for i in range(3))
    return numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1) / 2


def uniform(shape, count, random):
    """Points uniform by area."""
    weights = areas(shape)
    chosen = shape.triangles[random.choice(len(weights), count, p=weights / weights.sum())]
    root, along = numpy.sqrt(random.random((count, 1))), random.random((count, 1))
    a, b, c = (shape.vertices[chosen[:, i]] for i in range(3))
    return (1 - root) * a + root * (1 - along) * b + root * along * c


def spacing_for(shape, count):
    """The distance that about `count` points keep."""
    return numpy.sqrt(PER_SQUARE * areas(shape).sum() / count)


def spread(shape, count, seed):
    """About `count` points no two of which are nearer than the spacing, and that spacing.

    Of uniform places in random order each one stays that no earlier one which stayed is too near to: all together, in
    rounds, whoever comes before all its neighbours that are left stays, and those neighbours go.
    """
    random = numpy.random.default_rng(seed)
    spacing = spacing_for(shape, count)
    places = uniform(shape, TRIED * count, random)
    one, other = cKDTree(places).query_pairs(spacing, output_type="ndarray").T  # one comes before other
    undecided = numpy.ones(len(places), bool)
    stays = numpy.zeros(len(places), bool)
    while undecided.any():
        first = undecided.copy()
        first[other] = False  # whoever has an undecided neighbour before it waits
        stays |= first
        gone = numpy.zeros(len(places), bool)
        gone[other[first[one]]] = True
        undecided &= ~first & ~gone
        left = undecided[one] & undecided[other]
        one, other = one[left], other[left]
    return places[stays], spacing


def with_noise(points, deviation, seed):
    """Every coordinate moved by a normally distributed error, and the largest distance that any point was moved."""
    moves = deviation * numpy.random.default_rng(seed).normal(size=points.shape)
    return points + moves, float(numpy.linalg.norm(moves, axis=1).max()) if deviation else 0.0
