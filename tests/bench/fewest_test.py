# SPDX-License-Identifier: GPL-3.0-or-later
"""The search for the fewest triangles at a distance."""
import unittest

from fewest import MOST, REACH, RESOLUTION, STEP, fewest


class Program:
    """Decimates as `distance_at` says, and counts how often it is asked."""

    def __init__(self, distance_at, least=4):
        self.distance_at, self.least, self.asked = distance_at, least, []

    def __call__(self, target):
        self.asked.append(target)
        made = max(target, self.least)
        distance = self.distance_at(made)
        return {"failure": "crashed"} if distance is None else {"triangles": made, "upper": distance}

    def search(self, limit, total=100_000, guess=1000, known=None):
        return fewest(self, {} if known is None else known, limit, total, guess)


class FewestTest(unittest.TestCase):
    def test_limit_of_a_smooth_surface_is_found_to_the_resolution(self):
        # The distance c / n is 1 at n = c.
        for exact in (50, 900, 1000, 1100, 40_000):
            program = Program(lambda n: exact / n)
            best, made = program.search(1.0)
            self.assertGreaterEqual(best["triangles"], exact)
            self.assertLessEqual(best["triangles"], exact * (1 + RESOLUTION) + 1)
            self.assertEqual(made, len(program.asked))
            self.assertLessEqual(made, 16)

    def test_first_number_is_the_guess(self):
        program = Program(lambda n: 700 / n)
        program.search(1.0, guess=650)
        self.assertEqual(program.asked[0], 650)

    def test_equal_distance_is_near_enough(self):
        best, _ = Program(lambda n: 1.0 if n == 1000 else 1000 / n).search(1.0)
        self.assertEqual(best["triangles"], 1000)

    def test_smaller_number_beyond_a_worse_one_is_found(self):
        # Near enough from 1300 on, and again between 850 and 1000.
        best, _ = Program(lambda n: 0.9 if 850 <= n <= 1000 else 1300 / n).search(1.0, guess=1400)
        self.assertLessEqual(best["triangles"], 850 * (1 + RESOLUTION) + 1)

    def test_every_step_within_reach_is_tried(self):
        program = Program(lambda n: 1000 / n)
        best, _ = program.search(1.0)
        tried = sorted({target for target in program.asked if best["triangles"] / REACH <= target})
        for low, high in zip(tried, tried[1:]):
            self.assertLessEqual(high, STEP * low + 2)

    def test_nothing_is_asked_twice_and_known_results_count(self):
        known = {}
        program = Program(lambda n: 1000 / n)
        program.search(1.0, known=known)
        program.search(0.5, known=known)
        self.assertEqual(len(program.asked), len(set(program.asked)))
        _, made = program.search(1.0, known=known)
        self.assertEqual(made, 0)

    def test_program_that_cannot_remove_more_ends_the_search(self):
        program = Program(lambda n: 10 / n, least=500)
        best, made = program.search(1.0)
        self.assertEqual(best["triangles"], 500)
        self.assertLessEqual(made, 3)

    def test_program_that_never_comes_near_has_no_result(self):
        program = Program(lambda n: 2.0)
        best, made = program.search(1.0, total=5000)
        self.assertIsNone(best)
        self.assertEqual(max(program.asked), 5000)
        self.assertLess(made, MOST)

    def test_crash_counts_as_too_far(self):
        best, _ = Program(lambda n: None if n < 800 else 500 / n).search(1.0)
        self.assertGreaterEqual(best["triangles"], 800)
        self.assertLessEqual(best["triangles"], 800 * (1 + RESOLUTION) + 1)

    def test_distance_zero_goes_down_to_the_smallest_mesh(self):
        best, made = Program(lambda n: 0.0).search(0.0, total=5000)
        self.assertEqual(best["triangles"], 4)
        self.assertLess(made, MOST)

    def test_no_more_than_the_input_is_asked_for(self):
        program = Program(lambda n: 0.0 if n == 300 else 1.0)
        best, _ = program.search(1e-9, total=300, guess=9999)
        self.assertEqual(best["triangles"], 300)
        self.assertLessEqual(max(program.asked), 300)


if __name__ == "__main__":
    unittest.main()
