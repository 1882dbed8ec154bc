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


def cores(contender):
    """Processor time over time in the counted rounds; None for less than half a second: it comes in ticks of 10 ms."""
    total = sum(contender["seconds"])
    return contender["cpu_seconds"] / total if total >= 0.5 else None
