# SPDX-License-Identifier: GPL-3.0-or-later
"""What is taken from the program's report for the numbers of Wang 2006, and what the page says of it."""
import copy
import json
import math
import pathlib
import tempfile
import unittest

import wang_cases as cases
import wang_clouds as clouds
import paper_wang as thesis
import wang_numbers as numbers
import wang_page as page
import wang_probing as probing
import wang_tables as bench
from tables import scanmill


def step(name, seconds, **metrics):
    named = {key.replace("_", "-"): value for key, value in metrics.items()}
    return {"filter": name, "seconds": seconds, "metrics": named}


# A plate of 3 × 4 points: 12 = 2 · 12 − 2 · 1 − 10 triangles; one point is left over.
REPORT = {
    "steps": [
        {"seconds": 99.0, "properties": {"points": 130.0}},
        step("voxel-thin", 0.5, bin_size=2.0, kept=13.0),
        step("region-grow", 0.25, unused_points=1.0, holes=7.0),
        step("features", 0.125, holes=0.0, boundaries=1.0, creases=0.0),
        step("measure", 50.0, vertices=12.0, triangles=12.0, components=1.0, euler=1.0, genus=0.0, boundary_edges=10.0,
             boundary_loops=1.0, nonmanifold_edges=0.0, nonmanifold_vertices=0.0, misoriented_edges=0.0,
             self_intersections=0.0, p95=0.5, max=1.0, beyond_borders=20.0, diagonal=5.0),
    ],
    "cells": [{"scan": "plate.ply", "outcome": "ok", "steps": [0, 1, 2, 3, 4], "outputs": []}],
}


def entry(case="face", **more):
    made = {"case": case, "file": "plate.ply", "what": "a plate", "bin": "2 u", "failure": "", "skipped": ""}
    judgement = cases.judged(REPORT, REPORT["cells"][0])
    cases.take(made, copy.deepcopy(judgement), "1")
    cases.take(made, copy.deepcopy(judgement), "all")
    return {**made, **more}


def polygon(kind, radius, x, corners=6):
    angles = [2 * math.pi * number / corners for number in range(corners)]
    points = [[x + radius * math.cos(a), radius * math.sin(a), 1] for a in angles]
    return {"type": kind, "closed": True, "points": points}


class ReportTest(unittest.TestCase):
    def test_seconds_are_the_three_filters_and_neither_reading_nor_measuring(self):
        self.assertEqual(entry()["seconds"], {"1": [0.875], "all": [0.875]})

    def test_counts_come_from_the_steps_that_know_them(self):
        made = entry()
        names = ("points", "kept", "vertices", "triangles", "boundary_edges", "holes", "unused")
        self.assertEqual([made[name] for name in names], [130, 13, 12, 12, 10, 0, 1])
        self.assertTrue(made["manifold"])

    def test_scan_made_by_the_workflow_is_counted_where_it_was_made(self):
        report = copy.deepcopy(REPORT)
        report["steps"][0] = step("virtual-scan", 9.0, points=77.0)
        self.assertEqual(cases.judged(report, report["cells"][0])["points"], 77)

    def test_failed_run_is_a_failure_with_its_reason(self):
        made = entry()
        cases.take(made, cases.judged(REPORT, {"outcome": "failed", "error": "too flat"}), "1")
        self.assertEqual(made["failure"], "too flat")

    def test_runs_that_differ_are_an_error(self):
        other = cases.judged(REPORT, REPORT["cells"][0])
        with self.assertRaisesRegex(scanmill.Broken, "different triangles"):
            cases.take(entry(), {**other, "triangles": 13}, "1")

    def test_workflow_without_a_step_is_an_error_that_names_it(self):
        with self.assertRaisesRegex(scanmill.Broken, "no step features"):
            cases.judged(REPORT, {**REPORT["cells"][0], "steps": [0, 1, 2, 4]})

    def test_missing_files_are_failures_when_they_are_fetched_else_skipped(self):
        gone = pathlib.Path("/nowhere/gone.ply")
        self.assertIn("make data", cases.begun("face", "gone.ply", "", "1 u", gone)["failure"])
        skipped = cases.begun("face", "gone.ply", "", "1 u", gone, False)
        self.assertEqual((skipped["failure"], "does not fetch" in skipped["skipped"]), ("", True))

    def test_bin_sizes_are_told_apart_by_their_settings(self):
        found = bench.thinned({"steps": [
            {"filter": "voxel-thin", "parameters": {"derivatives": how, "origin": "nearest"},
             "metrics": {"bin-size": size, "kept": 5.0}} for how, size in (("exact", 0.5), ("thesis", 0.75))],
            "cells": [{"scan": "a", "outcome": "ok", "steps": [number]} for number in (0, 1)]})
        self.assertEqual(found, {"exact, nearest": {"bin_size": 0.5, "kept": 5},
                                 "thesis, nearest": {"bin_size": 0.75, "kept": 5}})

    def test_bisection_finds_the_bins_that_keep_a_number(self):
        # Of a plate of area 100 bins of B keep 100 / B².
        found = bench.bin_that_keeps(50, lambda size: 100 / size**2, 0.5, 4, steps=30)
        self.assertAlmostEqual(found, math.sqrt(2))

    def test_features_are_those_written_as_json(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "a.json"
            file.write_text(json.dumps({"polylines": []}))
            outputs = [{"kind": "features", "outcome": "ok", "file": "a.vtp"},
                       {"kind": "features", "outcome": "ok", "file": str(file)}]
            self.assertEqual(scanmill.features({"scan": "a", "outputs": outputs}), {"polylines": []})
        with self.assertRaisesRegex(scanmill.Broken, "a: the workflow wrote no features"):
            scanmill.features({"scan": "a", "outputs": outputs[:1]})


class HolesTest(unittest.TestCase):
    def test_radii_of_regular_polygons_are_known(self):
        # Along a hexagon's sides, from corner to corner by trapezoids: all corners are at the radius.
        found = cases.round_holes({"polylines": [polygon("hole", 5, 30), polygon("outer boundary", 50, 0),
                                                 polygon("hole", 21, 0)]})
        self.assertEqual(len(found), 2)
        for hole, radius, x in zip(found, (21, 5), (0, 30)):
            for name in ("mean", "least", "largest"):
                self.assertAlmostEqual(hole[name], radius)
            for one, other in zip(hole["middle"], (x, 0, 1)):
                self.assertAlmostEqual(one, other)

    def test_middle_does_not_lean_to_where_points_are_dense(self):
        square = {"type": "hole", "closed": True,
                  "points": [[-1, -1, 0], [1, -1, 0], [1, -0.5, 0], [1, 0, 0], [1, 0.5, 0], [1, 1, 0], [-1, 1, 0]]}
        hole = cases.round_holes({"polylines": [square]})[0]
        self.assertAlmostEqual(hole["middle"][0], 0)
        self.assertAlmostEqual(hole["largest"], math.sqrt(2))
        self.assertAlmostEqual(hole["least"], 1)


def touch(left, right, low, high, assumed=False):
    return {"left-normal": left, "assumed": assumed, "right-normal": right,
            "interior-angle": math.pi / 2, "phi-min": low and math.radians(low),
            "phi-max": high and math.radians(high)}


class ProbingTest(unittest.TestCase):
    def test_formulas_give_the_ranges_of_equation_5_7(self):
        # acos(0.2 / 5) = 87.708 degrees, without atan(H / R) of the two cones, or half of 90 degrees and it.
        halves = [31.40, 37.51, 42.71, 49.05, 56.74, 37.05, 29.43, 25.21, 20.21]
        centres = [90, 90, 90, 90, 90, 129.35, 121.72, 117.50, 112.50]
        for case, half, centre in zip(thesis.PROBING, halves, centres):
            self.assertAlmostEqual(probing.half_range(case), half, delta=0.005)
            self.assertAlmostEqual(probing.centre(case), centre, delta=0.006)

    def test_directions_are_counted_from_the_axis(self):
        self.assertAlmostEqual(probing.in_the_tables_angle([3, 4, 0]), 90)
        self.assertAlmostEqual(probing.in_the_tables_angle([0, 0, 2]), 180)
        self.assertAlmostEqual(probing.in_the_tables_angle([1, 0, 1]), 135)

    def test_medians_are_over_the_touches_that_have_a_range(self):
        found = probing.planned({"touches": [touch([0, 0, 1], [1, 0, 0], -10, 20), touch([1, 0, 0], [0, 0, 1], -20, 20),
                                             touch([0, 0, 1], [0, 0, 1], None, None),
                                             touch([0, 0, 1], [0, 1, 0], -1, 1, assumed=True)]})
        self.assertEqual((found["touches"], found["ranges"]), (4, 2))
        self.assertAlmostEqual(found["half"], 17.5)
        self.assertAlmostEqual(found["centre"], 135)
        self.assertAlmostEqual(found["interior_angle"], 90)
        with self.assertRaisesRegex(scanmill.Broken, "no touch with a range"):
            probing.planned({"touches": [touch([0, 0, 1], [0, 0, 1], None, None)]})

    def test_plan_is_the_one_written_as_json(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "plan.json"
            file.write_text(json.dumps({"touches": []}))
            outputs = [{"kind": "probes", "outcome": "ok", "file": "plan.vtp"},
                       {"kind": "probes", "outcome": "ok", "file": str(file)}]
            self.assertEqual(probing.plan_of({"outputs": outputs}), {"touches": []})
        with self.assertRaisesRegex(scanmill.Broken, "too flat"):
            probing.plan_of({"outputs": [], "error": "too flat"})

    def test_page_says_what_agrees_and_what_does_not(self):
        measured = [{"interior_angle": probing.interior_angle(case), "touches": 60, "ranges": 60}
                    for case in thesis.PROBING]
        centres, halves, angles = probing.remarks(measured)
        self.assertIn("within 1 degree of the true one in 9 of 9 cases.", angles)
        measured[4]["interior_angle"] = 90
        self.assertIn("8 of 9 cases; edges of 62 (90) degrees are blunted", probing.about_the_mesh(measured))
        self.assertIn("8 of 9 within 0.55 degrees", centres)
        self.assertIn("100, 100 of table 5.2, which prints 116.4 instead of 112.5", centres)
        self.assertIn("10.9 to 16.3 degrees smaller", halves)
        self.assertIn("Scanmill follows the equation", halves)
        measured[0]["ranges"] = 20
        self.assertIn("has a range at 20 of 60 touches; the edge's length gives 63", probing.remarks(measured)[3])
        entry = {"interior_angle": 112.5, "centre": 90.5, "half": 31.5, "touches": 99, "ranges": 63}
        row = probing.row(thesis.PROBING[0], entry)
        self.assertEqual(row, ["5.1", "bicone", "150, 100", "72.1 to 107.9", "90.00", "17.90", "90.00", "31.40",
                               "58.60 to 121.40", "112.5 (112.6)", "90.5", "31.5", "63 / 99 / 63"])
        self.assertEqual(len(row), len(probing.HEADER))


class PageTest(unittest.TestCase):
    def test_thesis_lines_follow_from_what_was_printed(self):
        # 978 / 11521 = 8.5 %; 2 · 978 + 2 · 4 − 1386 = 578.
        self.assertEqual(page.printed_line("block")[1:9], ["11,521", "3 mm", "978", "8.5 %", "1,386", "578", -4, ""])
        self.assertEqual(page.printed_line("hyperboloid")[5], "not printed")

    def test_our_line_has_distances_in_bins(self):
        line = ["plate.ply", "130", "2", "13", "10.0 %", "12", "10", 1, 1, 1, 0, 0, "0.25, 0.50", "20", "0.88 / 0.88"]
        self.assertEqual(page.our_line(entry()), line)

    def test_counts_that_contradict_each_other_are_told(self):
        self.assertEqual(page.expected_triangles(entry()), 12)
        self.assertIn("F = 2 V − 2 χ − b = 12", page.remark(entry()))
        self.assertIn("Euler's identity gives 14", page.remark(entry(euler=0)))
        self.assertIn("not an oriented manifold", page.remark(entry(manifold=False)))

    def test_points_left_over_and_intersections_are_told(self):
        self.assertIn("kept points in no triangle: 1", page.remark(entry()))
        self.assertNotIn("intersect", page.remark(entry()))
        told = page.remark(entry(kept=12, self_intersections=3))
        self.assertIn("every kept point is in a triangle", told.lower())
        self.assertIn("pairs of intersecting triangles: 3", told)

    def test_holes_that_the_thesis_does_not_show_are_told(self):
        self.assertNotIn("holes:", page.remark(entry()))
        self.assertIn("holes: 2 instead of 0", page.remark(entry(holes=2)))
        self.assertIn("riangles per point: 1.00, in the thesis 1.94", page.remark(entry()))

    def test_radii_are_told_in_bins_with_what_is_more_than_one(self):
        holes = [{"mean": 21.5, "least": 21, "largest": 22}, {"mean": 7.5, "least": 5, "largest": 9}]
        told = page.remark(entry("block", radii=holes, holes=5))
        self.assertIn("ole of radius 21: mean radius 21.50 (21.00 to 22.00), 0.25 voxel edges too large;", told)
        self.assertIn("7.50 (5.00 to 9.00), 1.25 voxel edges too large, which is more than one voxel", told)
        self.assertIn("from the true ones by at most 1.25 voxel edges",
                      page.conclusion([entry("block", radii=holes, holes=5)]))

    def test_border_of_the_block_is_its_face_and_its_holes(self):
        # 2 (88 + 95) + 2 π (21 + 4 · 5) = 623.6, 312 bins of 2.
        self.assertIn("has a length of 624, or 312 voxel edges", page.remark(entry("block", radii=[])))
        self.assertNotIn("boundary", page.remark(entry()))

    def test_topology_of_the_mesh_that_points_are_from_is_told_beside_ours(self):
        told = page.remark(entry(model={"loops": 7, "genus": None, "components": 2}))
        self.assertIn("loops: 1, handles: 0, components: 1; in the mesh that the points come from: loops: 7, handles: "
                      "unknown, components: 2", told)
        self.assertNotIn("points come from", page.remark(entry(model=None)))

    def test_skipped_and_failed_have_no_numbers(self):
        for name in ("skipped", "failure"):
            made = {"case": "face", "file": "face.ply", "what": "a face", "failure": "", "skipped": "", name: "gone"}
            self.assertEqual(page.our_line(made)[1:-1], [""] * (len(page.HEADER) - 2))
            self.assertIn("gone", page.remark(made))
        self.assertEqual(page.conclusion([made]), "Nothing ran.")

    def test_page_has_every_number_of_the_thesis(self):
        sizes = {f"{how}, {origin}": {"bin_size": 0.5, "kept": 900} for how in ("exact", "thesis")
                 for origin in ("nearest", "centroid")}
        results = {"points": {name: 100 for name in clouds.CLOUDS}, 
                   "binning": {name: {"kept": 345, "bin_size": 1.75} for name in ("hemisphere-8", "hyperboloid")},
                   "thinning": {name: sizes for name in ("hemisphere-8", "cone", "hyperboloid")},
                   "cases": [entry("hyperboloid")]}
        rows = numbers.rows(results)
        printed = [str(row[2]) for row in rows]
        for number in ("11.46°", "188", "292", "1,376", "1.2", "223", "1,247", "15.25", "0.103", "7,837", "1.42",
                       "0.21", "707"):
            self.assertIn(number, printed)
        text = " ".join(str(cell) for row in rows for cell in row)
        # √3 · 0.7303; 8 / 3 · 0.02 / 0.103²; 3 / 8 · 0.21² · 1.3889.
        for number in ("0.5164", "0.7303", "1.265", "5.03", "0.0591", "0.889", "1.389", "0.0230", "345", "1.111",
                       "1.8 mm"):
            self.assertIn(number, text)
        self.assertEqual({len(row) for row in rows}, {len(numbers.HEADER)})


if __name__ == "__main__":
    unittest.main()
