# SPDX-License-Identifier: GPL-3.0-or-later
"""Judges reconstructions, and finds the limits of noise and density."""

#: The largest allowed distance, in spacings. Gaps between points cause up to about 1.25, for example at a corner. The
#: bound does not grow with the noise, because it would soon be as large as the shape.
LARGEST = 3

SUCCESS = "success"
#: The kinds of failure, in the order in which they are checked, with their sentences for the page.
FAILURES = {
    "crashed": "the program crashed, or exceeded its limit of time or memory",
    "refused": "the program refused the points with a reason",
    "open": "the mesh is not a closed manifold",
    "pieces": "the mesh has more than one connected component",
    "genus": "the mesh has another number of handles than the truth",
    "far": "the mesh is too far from the truth",
}
#: Failures without a result; for the others the program delivered a mesh.
OF_THE_PROGRAM = ("crashed", "refused")


def bound(spacing):
    return LARGEST * spacing


def judge(outcome, cause, metrics, genus, largest_distance):
    """Returns SUCCESS or a name of FAILURES. `outcome` and `cause` come from the cell, `metrics` from measure (empty if
    it did not run). A missing metric or NaN is never a success."""
    if outcome not in ("ok", "doubtful"):
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
    """The number of successes and of trials."""
    return sum(verdict == SUCCESS for verdict in verdicts), len(verdicts)


def reliable_until(cells):
    """Two levels from (level, verdicts), ordered from the easiest to the hardest: the last level up to which every
    trial succeeds (None if the easiest has a failure), and the first level from which on none succeeds (None if the
    hardest has a success)."""
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
