# SPDX-License-Identifier: GPL-3.0-or-later
"""The rows of surfaces.py: numbers beside those of the model, and filters that made no mesh."""
import unittest

try:
    import surfaces
except ImportError:
    surfaces = None


def record(**facts):
    made = {"outcome": "ok", "seconds": 1.26, "vertices": 99, "closed": True, "pieces": 1, "loops": 0, "genus": 1,
            "mean": 0.01234, "largest": 2.345, "intersections": 3}
    return {"points": 100, "truth": {"pieces": 1, "loops": 0, "genus": 1}, "surfaces": {"sculpt": made | facts}}


@unittest.skipIf(surfaces is None, "needs numpy")
class Rows(unittest.TestCase):
    def test_equal_counts_have_no_brackets(self):
        self.assertEqual(surfaces.row_of(record(), "sculpt"),
                         ["sculpt", "yes", 1, 0, 1, "0.0123", "2.35", "99.0 %", 3, "1.3", "ok"])

    def test_other_counts_are_followed_by_those_of_the_model(self):
        row = surfaces.row_of(record(closed=False, loops=4, genus=None), "sculpt")
        self.assertEqual(row[1:5], ["no", 1, "4 (0)", "none (1)"])

    def test_a_refusal_has_no_distances(self):
        refused = {"surfaces": {"big-balls": {"outcome": "failed", "seconds": 0, "reason": "no"}}}
        row = surfaces.row_of(refused, "big-balls")
        self.assertEqual((row[0], row[1:9], row[-1]), ("tight-cocone, big-balls", [""] * 8, "failed"))


if __name__ == "__main__":
    unittest.main()
