# SPDX-License-Identifier: GPL-3.0-or-later
"""When a reconstruction counts as one, and where along noise or density it stops to be one."""

#: In spacings. Gaps between points allow for up to about 1.25, at a corner say. The bound does not grow with the
#: noise: it would soon be as large as the shape, and then anything passes.
LARGEST = 3

SUCCESS = "success"
#: What went wrong, in the order in which it is looked for, each with its sentence for the page.
FAILURES = {
    "crashed": "the program crashed, or ran out of time or memory",
    "refused": "the program refused the points with a reason",
    "open": "the mesh is not a closed manifold",
    "pieces": "it has more than one piece",
    "genus": "it has another number of handles",
    "far": "it is too far from the truth",
}
#: Of these the program is at fault; the others are results that it delivered.
OF_THE_PROGRAM = ("crashed", "refused")


def bound(spacing):
    return LARGEST * spacing


def judge(outcome, cause, metrics, genus, largest_distance):
    """SUCCESS or a name of FAILURES. `outcome` and `cause` are the cell's, `metrics` those of measure (none when it did
    not run). What is not told or is no number never counts as success."""
    if outcome != "done":
        return "refused" if cause == "refused" else "crashed"
    if not metrics:
        return "crashed"
    if metrics.get("closed") != 1:
        return "open"
    if metrics.get("components") != 1:
        return "pieces"
    if metrics.get("genus") != genus:
        return "genus"
    distance = metrics.get("hausdorff")
    return SUCCESS if distance is not None and distance <= largest_distance else "far"


def rate(verdicts):
    """Successes and trials."""
    return sum(verdict == SUCCESS for verdict in verdicts), len(verdicts)


def reliable_until(cells):
    """Of (level, verdicts) from the easiest to the hardest: the last level up to which every trial succeeded, None when
    the easiest had a failure; and the first from which on none does, None when the hardest has a success."""
    last, first = None, None
    for level, verdicts in cells:
        succeeded, trials = rate(verdicts)
        if succeeded < trials or not trials:
            break
        last = level
    for level, verdicts in reversed(cells):
        if rate(verdicts)[0]:
            break
        first = level
    return last, first
