# SPDX-License-Identifier: GPL-3.0-or-later
"""Searches the smallest number of triangles at which a decimated mesh is near enough to its input.

The distance does not fall monotonically with the number of triangles: on the kitten, meshoptimizer keeps 1 % of the
diagonal with 884 triangles, but not with 1,300. A bisection alone would find one of several limits. Below the smallest
number that is near enough, the search therefore also tries every number in steps of STEP, down to a share of 1 / REACH.
"""
import math

STEP, REACH = 1.1, 1.6
#: The search ends when a number that is at most this share smaller is known to be too small.
RESOLUTION = 0.01
#: Evaluations of one search.
MOST = 24
#: A result with more triangles than asked for, by this factor, shows that the program cannot remove more.
STUCK = 1.01
#: No mesh has fewer triangles.
FEWEST = 4


def distance(evaluation):
    """Infinite for a failure."""
    return evaluation.get("upper", math.inf)


def fewest(evaluate, known, limit, total, guess):
    """The evaluation with the fewest triangles among those whose distance is at most `limit`, and the number of
    evaluations made; None instead of the evaluation if the distance of all is larger.

    `evaluate(target)` decimates to `target` triangles, at most `total`, and returns a dictionary: "triangles" and
    "upper", or "failure". `known` holds evaluations by target; the search adds its own to it. `guess` is the first
    target if nothing is known.
    """
    made = 0
    while made < MOST:
        target = next_target(known, limit, total, guess)
        if target is None:
            break
        known[target] = evaluate(target)
        made += 1
    near = [evaluation for evaluation in known.values() if distance(evaluation) <= limit]
    return min(near, key=lambda evaluation: evaluation["triangles"], default=None), made


def next_target(known, limit, total, guess):
    """None if the search has ended."""
    enough = min((target for target, one in known.items() if distance(one) <= limit), default=None)
    too_few = sorted((target for target, one in known.items()
                      if distance(one) > limit and (enough is None or target < enough)), reverse=True)
    if not known:
        return min(max(guess, FEWEST), total)
    if enough is None:
        more = too_few[0] * factor(distance(known[too_few[0]]), limit)
        return min(math.ceil(more), total) if too_few[0] < total else None
    if enough <= FEWEST or known[enough]["triangles"] > STUCK * enough:
        return None
    if not too_few:
        return max(math.floor(enough / factor(limit, distance(known[enough]))), FEWEST)
    ends = too_few[0], enough
    if enough > STEP * too_few[0] + 1:
        return between(known, *ends, limit)
    untried = first_gap([enough, *too_few])
    if untried:
        return untried
    return between(known, *ends, limit) if enough - too_few[0] > max(1, RESOLUTION * enough) else None


def first_gap(tried):
    """The largest number to try below the first of the numbers, which are decreasing; None if all steps are tried."""
    least = max(math.ceil(tried[0] / REACH), FEWEST)
    for number, next_ in zip(tried, [*tried[1:], 0]):
        untried = math.floor(number / STEP)
        if untried < least:
            return None
        if next_ < untried:
            return untried
    return None


def factor(larger, smaller):
    """A factor of the number of triangles. On smooth surfaces the distance is inversely proportional to it."""
    return 1.05 * min(max(larger / smaller, 1.1), 4) if smaller > 0 else 4


def between(known, low, high, limit):
    """A number between `low`, which is too small, and `high`. The logarithm of the distance is interpolated linearly,
    but the number does not come close to either end."""
    above, below = distance(known[low]), distance(known[high])
    known_both = min(limit, below) > 0 and math.isfinite(above)
    share = math.log(above / limit) / math.log(above / below) if known_both else 0.5
    found = round(low * (high / low) ** min(max(share, 0.2), 0.8))
    return min(max(found, low + 1), high - 1)
