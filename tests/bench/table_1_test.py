# SPDX-License-Identifier: GPL-3.0-or-later
"""What is taken from the program's report for a paper's table, and what the page says of it."""
import copy
import unittest

import bernardini_table_1 as bench
import table_1_page as page
from paper_table_1 import PAPER, STAND_INS, WITHOUT
from tables.paper import take
from tables.scanmill import Broken


def step(name, seconds, **metrics):
    return {"filter": name, "seconds": seconds, "metrics": metrics}


# 1,000 points of which one lies on another and 2 stay inside; 2 (999 - 2) - 4 + 4 = 1994 triangles on a genus of 1.
REPORT = {
    "steps": [
        {"seconds": 99.0, "properties": {"points": 1000.0}},
        step("delaunay", 0.5, cells=6000.0, duplicates=1.0),
        step("alpha-solid", 0.25, **{"alpha": 0.5, "cells": 4000.0, "interior-points": 50.0, "uncovered-points": 0.0}),
        step("sculpt", 0.125, **{"removed": 400.0, "removed-exposing": 48.0, "interior-points": 2.0}),
    ],
    "cells": [{
        "scan": "femur.off", "outcome": "ok", "steps": [0, 1, 2, 3],
        "outputs": [{"file": "out/femur.stl", "kind": "mesh", "outcome": "ok", "properties": {
            "closed": True, "components": 1.0, "genus": 1.0, "triangles": 1994.0}}],
    }],
}


def entry(paper="Femur", model=None, **more):
    made = {"paper": paper, "file": "femur.off", "what": "a bone", "failure": "", "skipped": ""}
    judgement = bench.judged(REPORT, REPORT["cells"][0])
    take(made, copy.deepcopy(judgement), "1")
    take(made, copy.deepcopy(judgement), "all")
    return {**made, "spacing": 0.125, "model": model, **more}


class ReportTest(unittest.TestCase):
    def test_seconds_are_the_three_filters_and_not_the_reading(self):
        self.assertEqual(entry()["seconds"], {"1": [0.875], "all": [0.875]})

    def test_counts_come_from_the_steps_that_know_them(self):
        made = entry()
        found = {name: made[name] for name in ("points", "duplicates", "tetrahedra", "removed", "inside", "genus")}
        self.assertEqual(list(found.values()), [1000, 1, 4000, 400, 2, 1])

    def test_failed_scan_is_a_failure_with_its_reason(self):
        made = entry()
        take(made, bench.judged(REPORT, {"outcome": "failed", "error": "too flat"}), "1")
        self.assertEqual(made["failure"], "too flat")

    def test_runs_that_differ_are_an_error(self):
        other = bench.judged(REPORT, REPORT["cells"][0])
        with self.assertRaisesRegex(Broken, "different triangles"):
            take(entry(), {**other, "triangles": 1996}, "1")

    def test_workflow_without_a_step_is_an_error_that_names_it(self):
        cell = {**REPORT["cells"][0], "steps": [0, 1, 2]}
        with self.assertRaisesRegex(Broken, "no step sculpt"):
            bench.judged(REPORT, cell)

    def test_more_than_one_mesh_is_an_error(self):
        cell = {**REPORT["cells"][0], "outputs": REPORT["cells"][0]["outputs"] * 2}
        with self.assertRaisesRegex(Broken, "wrote 2 meshes"):
            bench.judged(REPORT, cell)


class PageTest(unittest.TestCase):
    def test_paper_lines_follow_from_what_was_printed(self):
        # 2 * 9807 - 4 = 19610; 36182 / 9807 = 3.69; 3704 / 36182 = 10.2 %.
        line = ["**Femur**", "9,807", "1.5 min", "36,182", "3.69", "3,704", "10.2 %", "19,610", "+0", "", "", ""]
        self.assertEqual(page.printed_line("Femur"), line)
        self.assertEqual(page.printed_line("CSG Solid")[8], "+12")
        self.assertEqual(page.printed_line("Bunny")[8], "-18")

    def test_our_line_counts_distinct_points(self):
        line = ["femur.off", "999", "0.88 / 0.88 s", "4,000", "4.00", "400", "10.0 %", "1,994", "+0", "2", "1", "4.0"]
        self.assertEqual(page.our_line(entry()), line)

    def test_counts_that_contradict_each_other_are_told(self):
        self.assertEqual(page.expected_triangles(entry()), 1994)
        self.assertEqual(page.expected_triangles(entry(components=2)), 1990)
        self.assertNotIn("contradict", page.remark(entry()))
        told = page.remark(entry(triangles=1990))
        self.assertIn("1,990 triangles, but points, components and genus give 1,994", told)

    def test_points_left_inside_and_a_genus_that_is_not_the_models_are_told(self):
        model = {"closed": True, "genus": 0, "components": 1, "largest_distance": 0.01, "mean_distance": 0.001}
        told = page.remark(entry(model=model))
        self.assertIn("Points not on the surface: 2 (0.2 %), before sculpting 50", told)
        self.assertIn("genus 1 (components: 1), but the model has genus 0", told)
        self.assertIn("mean 0.1 % of the diagonal, largest 1 %", told)
        self.assertIn("Every point is on the surface", page.remark(entry(inside=0, triangles=1998)))

    def test_difference_from_the_paper_is_told_beyond_a_tenth(self):
        # 10.0 % removed where the paper has 10.2 %; 4.00 tetrahedra per point where it has 3.69.
        self.assertNotIn("removes", page.remark(entry()))
        self.assertIn("removes 5.0 % of the alpha-solid's tetrahedra, in the paper 10.2 %",
                      page.remark(entry(removed=200)))
        self.assertIn("1.36 times the paper's tetrahedra per point", page.remark(entry(tetrahedra=5000)))
        # 90 s / 9807 points over 0.875 s / 999 points.
        self.assertIn("per point, our run is 10 times as fast", page.remark(entry()).lower())

    def test_notes_tell_what_the_paper_printed(self):
        self.assertIn("4 of its 8 lines have exactly 2n − 4", page.notes({"rounds": 5}))

    def test_skipped_and_failed_have_no_numbers(self):
        for name in ("skipped", "failure"):
            made = {"paper": "Club", "file": "club.ply", "what": "a club", "failure": "", "skipped": "", name: "gone"}
            self.assertEqual(page.our_line(made)[1:-1], [""] * (len(page.HEADER) - 2))
            self.assertIn("gone", page.remark(made))
        self.assertEqual(page.conclusion([made]), "Nothing ran.")

    def test_conclusion_counts_whole_surfaces(self):
        told = page.conclusion([entry(), entry(inside=0)])
        self.assertIn("In 1 of 2 objects every point is on the surface. Points are left inside the solid in femur.off "
                      "(points: 2,", told)
        self.assertIn("8.76 s per 10,000 points", told)

    def test_every_object_of_the_paper_has_a_stand_in_or_is_said_to_have_none(self):
        stood_for = {one.paper for one in STAND_INS} - {""}
        self.assertEqual(stood_for | set(WITHOUT), set(PAPER))
        self.assertEqual(WITHOUT, ["Tibia", "Fibula", "Patella"])


if __name__ == "__main__":
    unittest.main()
