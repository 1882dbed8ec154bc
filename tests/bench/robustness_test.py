# SPDX-License-Identifier: GPL-3.0-or-later
"""When a reconstruction counts, where the border runs, and what the page says of it."""
import unittest

import summary
import verdict

GOOD = {"closed": 1.0, "components": 1.0, "genus": 1.0, "hausdorff": 0.3}


def judged(outcome="ok", cause=None, genus=1, largest=0.3, **metrics):
    return verdict.judge(outcome, cause, {**GOOD, **metrics}, genus, largest)


class VerdictTest(unittest.TestCase):
    def test_success_is_closed_in_one_piece_with_the_right_handles_and_near(self):
        self.assertEqual(judged(), verdict.SUCCESS)  # exactly on the bound

    def test_each_defect_has_its_name(self):
        self.assertEqual(judged(closed=0.0), "open")
        self.assertEqual(judged(components=2.0), "pieces")
        self.assertEqual(judged(genus=0), "genus")
        self.assertEqual(judged(largest=0.29), "far")

    def test_what_failed_to_run_is_no_success_whatever_was_measured(self):
        self.assertEqual(judged(outcome="failed", cause="refused"), "refused")
        for cause in ("signal", "time", "memory", "exit", "exception", None):
            self.assertEqual(judged(outcome="failed", cause=cause), "crashed")
        self.assertEqual(judged(outcome="skipped"), "crashed")
        self.assertEqual(verdict.judge("ok", None, {}, 1, 9.0), "crashed")

    def test_what_is_not_told_or_no_number_is_no_success(self):
        for name, expected in (("closed", "open"), ("components", "pieces"), ("genus", "genus"), ("hausdorff", "far")):
            for value in (None, float("nan")):
                self.assertEqual(judged(**{name: value}), expected)
            without = {other: value for other, value in GOOD.items() if other != name}
            self.assertEqual(verdict.judge("ok", None, without, 1, 0.3), expected)

    def test_bound_is_a_number_of_spacings_whatever_the_noise(self):
        self.assertEqual(verdict.bound(0.5), verdict.LARGEST * 0.5)


class BorderTest(unittest.TestCase):
    def border(self, *counts):
        """Of (successes, failures) per level 0, 1, 2 …"""
        return verdict.reliable_until(
            [(level, ["success"] * good + ["genus"] * bad) for level, (good, bad) in enumerate(counts)]
        )

    def test_border_is_the_last_level_before_any_failure(self):
        self.assertEqual(self.border((5, 0), (5, 0), (4, 1), (5, 0), (0, 5)), (1, 4))

    def test_never_begins_after_the_last_success(self):
        self.assertEqual(self.border((5, 0), (0, 5), (1, 4), (0, 5), (0, 5)), (0, 3))

    def test_there_may_be_no_border(self):
        self.assertEqual(self.border((5, 0), (5, 0)), (1, None))
        self.assertEqual(self.border((4, 1), (1, 4)), (None, None))

    def test_level_without_a_trial_is_not_reliable(self):
        self.assertEqual(self.border((5, 0), (0, 0), (5, 0)), (0, None))


def trial(level, judgement, axis="noise", inside=0, mean=0.01, error="", shape="ball"):
    return {"shape": shape, "axis": axis, "level": level, "seed": 1, "points": 200, "spacing": 0.1, "bound": 0.15,
            "verdict": judgement, "inside": inside, "mean": mean, "hausdorff": mean and 2 * mean, "error": error,
            "warned": judgement == "far", "farthest_move": 0.1 * level,
            "before": "success" if level < 2 else "pieces", "inside_before": inside and 10 * inside}


TRIALS = [
    trial(0, "success"), trial(0, "success", inside=4),
    trial(1, "genus", inside=20), trial(1, "success", inside=10),
    trial(2, "refused", inside=None, mean=None, error="too few points"), trial(2, "far", inside=100, mean=0.2),
    trial(100, "genus", axis="density"), trial(1000, "success", axis="density"),
]
SHAPES = [{"name": "ball", "what": "round", "genus": 0, "triangles": 8}]


class SummaryTest(unittest.TestCase):
    def line(self, lines, begin):
        return next(line for line in lines if line.startswith(begin))

    def test_cell_tells_rate_and_reasons(self):
        levels = dict(summary.cells_of(TRIALS, "ball", "noise"))
        self.assertEqual([summary.cell(levels[level]) for level in (0, 1, 2)],
                         ["**2/2**", "1/2: 1 genus", "0/2: 1 refused, 1 far"])

    def test_median_is_over_what_was_told(self):
        levels = dict(summary.cells_of(TRIALS, "ball", "noise"))
        self.assertEqual([summary.inside(levels[level]) for level in (0, 1, 2)], ["1.0 %", "7.5 %", "50.0 %"])
        self.assertEqual([summary.mean_distance(levels[level]) for level in (0, 2)], ["0.10", "2.00"])
        self.assertEqual(summary.largest_distance(levels[2]), "4.00")
        self.assertEqual(summary.inside_before(levels[2]), "500.0 %")
        self.assertEqual(summary.before_sculpting(levels[2]), "0/2: 2 pieces")
        self.assertEqual(summary.inside([trial(3, "crashed", inside=None)]), "–")

    def test_density_goes_from_many_points_to_few(self):
        self.assertEqual([level for level, _ in summary.cells_of(TRIALS, "ball", "density")], [1000, 100])

    def test_border_is_told_from_the_table(self):
        text = summary.border(TRIALS, SHAPES)
        self.assertIn("All trials succeed with noise of up to 0 spacings", text)
        self.assertIn("all trials succeed up to 0, none succeeds from 2 on", text)
        self.assertIn("all trials succeed from 1,000 points on, none succeeds with 100 or fewer", text)
        self.assertIn("all points are on the surface: ball none", text)  # 4 points were left inside
        self.assertIn("before sculpting, with points inside: ball 1.", text)
        self.assertIn("From 2 on, noise moves some point of every scan farther", text)
        self.assertIn("4 of 8 trials failed. The most frequent reason: the mesh has another number of handles than the "
                      "truth (2)", text)
        self.assertIn("refused 1 and crashed in 0; in the other 3 it delivered a wrong mesh", text)
        self.assertIn("with a warning in 1 of them", text)

    def test_border_at_the_end_of_what_was_tried_is_told_as_such(self):
        good, mixed = ("success", "success"), ("success", "far")
        self.assertEqual(summary.noise_border("ball", [(0, good), (2, good)]),
                         "ball: all trials succeed up to 2, the largest tested")
        self.assertEqual(summary.noise_border("ball", [(0, mixed), (2, mixed)]),
                         "ball: some trials fail even without noise, some succeed at 2")
        self.assertEqual(summary.density_border("ball", [(900, good), (100, good)]),
                         "ball: all trials succeed from 100 points on, the fewest tested")
        self.assertEqual(summary.density_border("ball", [(900, good), (100, mixed)]),
                         "ball: all trials succeed from 900 points on, some succeed with 100")

    def test_page_shows_every_cell_and_what_the_program_said(self):
        load = {"took_seconds": 9.0, "others_cores": 0.5, "stolen_cpu_seconds": 0.0}
        machine = {"processor": "Abacus", "cores": 2, "memory_gibibytes": 4, "kernel": "6.1", "system": "Debian"}
        page = summary.lines({"command": "make bench-robustness", "date": "2026-01-02", "revision": "abc", "seeds": 2,
                              "machine": machine, "points": 200, "load": load, "shapes": SHAPES, "trials": TRIALS})
        self.assertEqual(self.line(page, "| ball"), "| ball | **2/2** | 1/2: 1 genus | 0/2: 1 refused, 1 far |")
        self.assertIn("- too few points", page)


if __name__ == "__main__":
    unittest.main()
