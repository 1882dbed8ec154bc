# SPDX-License-Identifier: GPL-3.0-or-later
"""Medians, spreads and ratios of the records. A contender that failed has none."""
import statistics


def counts(contender):
    """Whether its times may be shown: it finished every round that it began."""
    return not contender["failure"] and bool(contender["seconds"])


def spread(seconds):
    """Median, least and most."""
    return statistics.median(seconds), min(seconds), max(seconds)


def ratio(ours, other):
    """Median, least and most of the ratio of our seconds to the other's, per round that both did. None if one of them
    failed or their results are unequal."""
    if not counts(ours) or not counts(other) or ours["unequal"] or other["unequal"]:
        return None
    return spread([a / b for a, b in zip(ours["seconds"], other["seconds"])])


def bytes_per(contender, fact):
    """Peak memory beyond the resident memory before the work, per element of a fact; None if a number is unknown."""
    peak, before = contender["peak_mebibytes"], contender["resident_mebibytes_before"]
    count = contender["facts"].get(fact)
    if not counts(contender) or not peak or not before or not count or contender["peak_counts_loading"]:
        return None
    return (peak - before) * 2**20 / count


def growth(contender, smaller):
    """Ratio of its median seconds to those on a smaller input; None if one of them failed."""
    if not counts(contender) or not counts(smaller):
        return None
    return spread(contender["seconds"])[0] / spread(smaller["seconds"])[0]


def cores(contender):
    """Processor time divided by time in the counted rounds. None below half a second, because ticks take 10 ms."""
    total = sum(contender["seconds"])
    return contender["cpu_seconds"] / total if total >= 0.5 else None
