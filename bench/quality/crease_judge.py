# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares creases that were found with the true ones, by length."""
import numpy
from scipy.spatial import cKDTree


def segments(features):
    """The segments of the creases in a document of the kind features: arrays of their starts and of their ends."""
    starts, ends = [], []
    for line in features["polylines"]:
        if line["type"] != "crease":
            continue
        points = line["points"] + (line["points"][:1] if line["closed"] else [])
        starts += points[:-1]
        ends += points[1:]
    return numpy.reshape(numpy.array(starts, float), (-1, 3)), numpy.reshape(numpy.array(ends, float), (-1, 3))


def samples(lines, step):
    """Points in the middle of equal parts, of at most `step`, of every segment, and the length that each stands for."""
    return samples_of_segments(lines, step)[:2]


def samples_of_segments(lines, step):
    """The same, and the row of each point's segment."""
    starts, ends = lines
    lengths = numpy.linalg.norm(ends - starts, axis=1)
    parts = numpy.maximum(1, numpy.ceil(lengths / step)).astype(int)
    of = numpy.repeat(numpy.arange(len(parts)), parts)
    number = numpy.arange(len(of)) - numpy.repeat(numpy.cumsum(parts) - parts, parts)
    shares = ((number + 0.5) / parts[of])[:, None]
    return starts[of] * (1 - shares) + ends[of] * shares, (lengths / parts)[of], of


def share_within(lines, others, distance):
    """The share of the length of `lines` that is within `distance` of `others`; None without lines. The error of the
    distances is at most 1 % of `distance`."""
    step = distance / 50
    points, lengths = samples(lines, step)
    if not len(points):
        return None
    targets, _ = samples(others, step)
    if not len(targets):
        return 0.0
    near = cKDTree(targets).query(points, distance_upper_bound=distance)[0] <= distance
    return float(lengths[near].sum() / lengths.sum())


def judged(found, true, distance):
    """Of two documents: the length and the number of the creases found, the share of the true length that is within
    `distance` of them, and the share of their length that is farther from every true crease."""
    lines, right = segments(found), segments(true)
    within = share_within(lines, right, distance)
    return {
        "creases": sum(line["type"] == "crease" for line in found["polylines"]),
        "length": float(numpy.linalg.norm(lines[1] - lines[0], axis=1).sum()),
        "found": share_within(right, lines, distance),
        "false": 0.0 if within is None else 1 - within,
    }
