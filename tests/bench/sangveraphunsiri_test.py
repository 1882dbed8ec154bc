# SPDX-License-Identifier: GPL-3.0-or-later
import unittest

import sangveraphunsiri_table_1 as table_1
from tables import scanmill


def entry(**more):
    values = {
        "paper": "teeth", "file": "meshes/disc.off", "what": "a disc", "bin_size": "1 %diag", "failure": "",
        "model_genus": 0, "model_loops": 1,
    }
    return {**values, **more}


def disc(**more):
    """A fan of five triangles round a point."""
    values = {
        "max_edge": 2.0, "points": 6, "unused": 0, "triangles": 5, "closed": False, "loops": 1, "boundary_edges": 5,
        "components": 1, "genus": 0, "intersections": 0, "farthest": 0.01, "doubtful": False, "seconds": 0.5,
    }
    return {**values, **more}


class SangveraphunsiriTest(unittest.TestCase):
    def test_triangles_follow_from_the_other_counts(self):
        self.assertEqual(table_1.expected_triangles(disc()), 5)
        self.assertEqual(table_1.expected_triangles(disc(points=8, loops=0, boundary_edges=0, genus=0)), 12)
        with self.assertRaises(scanmill.Broken):
            table_1.take(entry(), disc(triangles=6), "1")

    def test_the_closed_model_of_the_paper_has_all_triangles(self):
        differences = {name: one.triangles - (2 * one.points - 4) for name, one in table_1.PAPER.items()}
        self.assertEqual(differences, {"human face": -49, "pan handle": 0, "teeth": -281, "car seat": -319})

    def test_line_shows_the_median_and_the_model(self):
        one = entry()
        for seconds in (1.0, 2.0, 9.0):
            table_1.take(one, disc(seconds=seconds), "1")
            table_1.take(one, disc(seconds=seconds / 2), "all")
        line = table_1.our_line(one)
        self.assertEqual(len(line), len(table_1.HEADER))
        self.assertEqual(line[5:8], ["5", "8", "-3"])
        self.assertEqual(line[-1], "2.000 / 1.000 s")
        self.assertIn("1 (1)", line)

    def test_runs_that_differ_are_refused(self):
        one = entry()
        table_1.take(one, disc(), "1")
        with self.assertRaises(scanmill.Broken):
            table_1.take(one, disc(farthest=0.02), "all")

    def test_conclusion_names_what_differs_from_the_model(self):
        one = entry(model_loops=3)
        table_1.take(one, disc(unused=0), "1")
        self.assertIn("disc.off (1 instead of 3)", table_1.conclusion([one]))
        self.assertEqual(table_1.conclusion([entry(failure="crash")]), "Nothing ran.")


if __name__ == "__main__":
    unittest.main()
