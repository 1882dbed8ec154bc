# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that contenders with the same work have the same result."""


def apart(value, reference):
    """The difference as a share of the reference; infinite if only the reference is zero."""
    if value == reference:
        return 0.0
    return abs(value - reference) / abs(reference) if reference else float("inf")


def check(row, entries):
    """Sets "unequal" (a sentence or empty) and "checked" (the number of compared facts) in every entry.

    Contenders that failed or do different work are left out. The first remaining contender that reports a fact is the
    reference for it. The times of a contender with an unequal fact are not compared. `entries` are the records of
    row.contenders, in order.
    """
    for entry in entries:
        entry["unequal"], entry["checked"] = "", 0
    taking_part = [
        (contender, entry)
        for contender, entry in zip(row.contenders, entries)
        if not entry["failure"] and not entry["differs"]
    ]
    for fact, usual_tolerance in row.agree.items():
        reporting = [(contender, entry) for contender, entry in taking_part if fact in entry["facts"]]
        for contender, entry in reporting[1:]:
            reference = reporting[0][1]
            reference["checked"] += 1
            entry["checked"] += 1
            tolerance = contender.agree.get(fact, usual_tolerance)
            value, expected = entry["facts"][fact], reference["facts"][fact]
            difference = apart(value, expected)
            if not difference <= tolerance and not entry["unequal"]:  # also true for NaN
                entry["unequal"] = (
                    f"{fact} is {value:,} where {reference['name']} has {expected:,}: "
                    f"{100 * difference:.3g} % apart, {100 * tolerance:.3g} % allowed"
                )
