# SPDX-License-Identifier: GPL-3.0-or-later
"""The shares of crease length that creases.py reports, for lines that can be measured by hand."""
import unittest

try:
    import numpy  # noqa: F401
    import scipy  # noqa: F401

    from crease_judge import judged, samples, segments
except ImportError:
    judged = None


def document(*lines, kind="crease", closed=False):
    return {"polylines": [{"type": kind, "closed": closed, "points": line} for line in lines]}


@unittest.skipIf(judged is None, "needs numpy and scipy")
class Judge(unittest.TestCase):
    def test_equal_lines_are_found_and_none_is_false(self):
        lines = document([[0, 0, 0], [10, 0, 0]], [[0, 5, 0], [0, 9, 0]])
        self.assertEqual(judged(lines, lines, 0.1), {"creases": 2, "length": 14.0, "found": 1.0, "false": 0.0})

    def test_half_of_a_line_is_half_of_its_length_whatever_its_segments(self):
        true = document([[0, 0, 0], [10, 0, 0]])
        half = document([[0, 0.05, 0], [1, 0.05, 0], [5, 0.05, 0]])
        one = judged(half, true, 0.1)
        self.assertAlmostEqual(one["found"], 0.5, delta=0.02)
        self.assertEqual(one["false"], 0)

    def test_a_line_elsewhere_is_false_by_its_length(self):
        true = document([[0, 0, 0], [10, 0, 0]])
        found = document([[0, 0, 0], [10, 0, 0]], [[0, 5, 0], [30, 5, 0]])
        self.assertAlmostEqual(judged(found, true, 0.1)["false"], 0.75)

    def test_a_line_just_beyond_the_distance_is_false(self):
        true, found = document([[0, 0, 0], [10, 0, 0]]), document([[0, 0.102, 0], [10, 0.102, 0]])
        one = judged(found, true, 0.1)
        self.assertEqual((one["found"], one["false"]), (0, 1))

    def test_no_line_finds_nothing_and_is_not_false(self):
        one = judged(document(), document([[0, 0, 0], [10, 0, 0]]), 0.1)
        self.assertEqual((one["creases"], one["found"], one["false"]), (0, 0, 0))

    def test_boundaries_do_not_count_and_closed_lines_return(self):
        self.assertEqual(len(segments(document([[0, 0, 0], [1, 0, 0]], kind="hole"))[0]), 0)
        square = document([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], closed=True)
        self.assertAlmostEqual(samples(segments(square), 0.3)[1].sum(), 4)


if __name__ == "__main__":
    unittest.main()
