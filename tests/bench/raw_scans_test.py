# SPDX-License-Identifier: GPL-3.0-or-later
"""The goals that a mesh of a raw scan misses."""
import unittest

from raw_scans_page import misses, summary


def record(noise=0.05, loops=0, **ours):
    facts = {"outcome": "ok", "seconds": 1.0, "mean": 0.01, "largest": 1.0, "f_score": 1.0, "pieces": 1, "loops": 0,
             "genus": 2, "intersections": 0, "triangles": 100, **ours}
    return {"noise": noise, "truth": {"pieces": 1, "loops": loops, "genus": 2, "intersections": 0},
            "surfaces": {"raw-scans": facts, "quickstart": facts, "Poisson": {"mean": 0.01},
                         "ball pivoting": {"pieces": 3, "loops": 5}}}


class MissesTest(unittest.TestCase):
    def missed(self, **changes):
        return misses(record(**changes), "raw-scans")

    def test_mesh_like_the_model_misses_nothing(self):
        self.assertEqual(self.missed(), [])

    def test_mean_counts_for_closed_models_with_noise_and_may_equal_that_of_poisson(self):
        self.assertEqual(self.missed(mean=0.0101), ["mean"])
        self.assertEqual(self.missed(mean=0.0101, noise=0), [])
        grown = {"components": 1, "loops": 1}
        self.assertEqual(self.missed(mean=0.0101, loops=1, grown=grown), ["loops"], "an open model")

    def test_topology_is_that_of_the_model(self):
        self.assertEqual(self.missed(pieces=2), ["pieces"])
        self.assertEqual(self.missed(loops=1, grown={"components": 1, "loops": 2}), ["loops"])
        self.assertEqual(self.missed(loops=1), ["loops"], "an open model was closed")
        self.assertEqual(self.missed(genus=0), ["genus"])
        self.assertEqual(self.missed(genus=None), ["genus"], "not a manifold")
        self.assertEqual(self.missed(intersections=1), ["cuts"])

    def test_pieces_and_loops_of_region_grow_are_no_more_than_those_of_ball_pivoting(self):
        self.assertEqual(self.missed(grown={"components": 1, "loops": 5}), [])
        self.assertEqual(self.missed(grown={"components": 1, "loops": 6}), ["ball"])
        self.assertEqual(self.missed(grown={"components": 4, "loops": 0}), ["ball"], "fewer loops do not make up for it")

    def test_run_without_a_mesh_has_no_mesh(self):
        failed = record()
        failed["surfaces"]["raw-scans"] = {"outcome": "failed", "seconds": 1.0}
        self.assertEqual(misses(failed, "raw-scans"), ["no mesh"])

    def test_summary_counts_misses_without_a_doubt(self):
        lines = summary([record(genus=0), record(genus=0, outcome="doubtful"), record()])
        self.assertIn("1 of 3 scans miss nothing, 1 miss a goal and are doubtful or failed, 1 miss one in silence "
                      "(genus 2)", lines[0])


if __name__ == "__main__":
    unittest.main()
