# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether contenders that claim to do the same work came to the same result."""


def apart(value, reference):
    """The difference as a share of the reference; infinite when that is zero and the value is not."""
    if value == reference:
        return 0.0
    return abs(value - reference) / abs(reference) if reference else float("inf")


def check(row, entries):
    """Fills in every entry "unequal", a sentence or empty, and "checked": in how many facts it was compared.

    Whoever failed or differs by nature is left out. Of the others the first that tells a fact is the reference for it;
    with an unequal fact a contender's times are not compared. `entries` are the records of row.contenders, in order.
    """
    for entry in entries:
        entry["unequal"], entry["checked"] = "", 0
    taking_part = [
        (contender, entry)
        for contender, entry in zip(row.contenders, entries)
        if not entry["failure"] and not entry["differs"]
    ]
    for fact, usual_tolerance in row.agree.items():
        telling = [(contender, entry) for contender, entry in taking_part if fact in entry["facts"]]
        for contender, entry in telling[1:]:
            reference = telling[0][1]
            reference["checked"] += 1
            entry["checked"] += 1
            tolerance = contender.agree.get(fact, usual_tolerance)
            value, expected = entry["facts"][fact], reference["facts"][fact]
            difference = apart(value, expected)
            if not difference <= tolerance and not entry["unequal"]:  # also when it is no number
                entry["unequal"] = (
                    f"{fact} is {value:,} where {reference['name']} has {expected:,}: "
                    f"{100 * difference:.3g} % apart, {100 * tolerance:.3g} % allowed"
                )
