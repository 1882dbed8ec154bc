# SPDX-License-Identifier: GPL-3.0-or-later
"""Medians, spreads and ratios of what was recorded. A contender that failed has none."""
import statistics


def counts(contender):
    """Whether its times may be shown: it ended every round that it began."""
    return not contender["failure"] and bool(contender["seconds"])


def spread(seconds):
    """Median, least and most."""
    return statistics.median(seconds), min(seconds), max(seconds)


def ratio(ours, other):
    """Median, least and most of our seconds over the other's, round by round, over the rounds that both did; None when
    one of them failed or the other's work turned out not to be equal."""
    if not counts(ours) or not counts(other) or ours["unequal"] or other["unequal"]:
        return None
    return spread([a / b for a, b in zip(ours["seconds"], other["seconds"])])


def bytes_per(contender, fact):
    """What the peak adds to what was resident before, for each of a fact's elements; None when one is not known."""
    peak, before = contender["peak_mebibytes"], contender["resident_mebibytes_before"]
    count = contender["facts"].get(fact)
    if not counts(contender) or not peak or not before or not count or contender["peak_counts_loading"]:
        return None
    return (peak - before) * 2**20 / count


def growth(contender, smaller):
    """Median seconds over those of the same contender on a smaller input; None when one of them failed."""
    if not counts(contender) or not counts(smaller):
        return None
    return spread(contender["seconds"])[0] / spread(smaller["seconds"])[0]


def cores(contender):
    """Processor time over time in the counted rounds; None for less than half a second: it comes in ticks of 10 ms."""
    total = sum(contender["seconds"])
    return contender["cpu_seconds"] / total if total >= 0.5 else None
