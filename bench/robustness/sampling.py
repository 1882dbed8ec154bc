# SPDX-License-Identifier: GPL-3.0-or-later
"""Evenly spread points on a mesh without gaps, like a careful scan without noise."""
import numpy
from scipy.spatial import cKDTree

#: Candidates per requested point. With this number, gaps rarely exceed 1.2 spacings.
TRIED = 20
#: Points per spacing² of evenly spread points without gaps, counted on large samples.
PER_SQUARE = 0.61


def areas(shape):
    a, b, c = (shape.vertices[shape.triangles[:, i]] for i in range(3))
    return numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1) / 2


def uniform(shape, count, random):
    """Random points, uniform by area."""
    weights = areas(shape)
    chosen = shape.triangles[random.choice(len(weights), count, p=weights / weights.sum())]
    root, along = numpy.sqrt(random.random((count, 1))), random.random((count, 1))
    a, b, c = (shape.vertices[chosen[:, i]] for i in range(3))
    return (1 - root) * a + root * (1 - along) * b + root * along * c


def spacing_for(shape, count):
    """The spacing at which about `count` points fit on the shape."""
    return numpy.sqrt(PER_SQUARE * areas(shape).sum() / count)


def spread(shape, count, seed):
    """About `count` points with at least the spacing between them, and that spacing.

    Takes uniform candidates in random order and accepts each one that is at least the spacing away from all earlier
    accepted ones. Works in parallel rounds: a round accepts every undecided candidate without an undecided earlier
    neighbour, and rejects its neighbours.
    """
    random = numpy.random.default_rng(seed)
    spacing = spacing_for(shape, count)
    places = uniform(shape, TRIED * count, random)
    one, other = cKDTree(places).query_pairs(spacing, output_type="ndarray").T  # index pairs with one < other
    undecided = numpy.ones(len(places), bool)
    stays = numpy.zeros(len(places), bool)
    while undecided.any():
        first = undecided.copy()
        first[other] = False  # candidates with an undecided earlier neighbour wait
        stays |= first
        gone = numpy.zeros(len(places), bool)
        gone[other[first[one]]] = True
        undecided &= ~first & ~gone
        left = undecided[one] & undecided[other]
        one, other = one[left], other[left]
    return places[stays], spacing


def with_noise(points, deviation, seed):
    """The points with a normally distributed error in every coordinate, and the largest move of a point."""
    moves = deviation * numpy.random.default_rng(seed).normal(size=points.shape)
    return points + moves, float(numpy.linalg.norm(moves, axis=1).max()) if deviation else 0.0
