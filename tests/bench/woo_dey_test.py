# SPDX-License-Identifier: GPL-3.0-or-later
import pathlib
import unittest

import woo_dey_table_1 as table_1
from tables import paper, scanmill


def step(name, seconds, **metrics):
    return {"filter": name, "seconds": seconds, "metrics": metrics}


# 12 points of which 2 are not on a closed surface of genus 0: 2 · 10 − 4 = 16 triangles.
REPORT = {
    "steps": [
        {"seconds": 99.0, "properties": {"points": 12.0}},
        step("delaunay", 0.5, cells=40.0, duplicates=0.0),
        step("tight-cocone", 0.25, **{"unused-points": 2.0, "poor": 3.0, "invented-area": 0.5}),
        step("measure", 77.0, area=2.0, hausdorff=0.5, diagonal=10.0),
    ],
    "cells": [{
        "scan": "cloud.xyz", "outcome": "ok", "steps": [0, 1, 2, 3],
        "outputs": [{"file": "cloud.ply", "kind": "mesh", "outcome": "ok", "properties": {
            "closed": True, "components": 1.0, "genus": 0.0, "triangles": 16.0}}],
    }],
}


def judgement(**more):
    return {**table_1.judged(REPORT, REPORT["cells"][0]), **more}


def entry(**more):
    made = {"paper": "golf club", "stage": "updated", "file": "meshes/handle.off", "what": "a part", "failure": "",
            "model_genus": 0}
    for threads in ("1", "all"):
        paper.take(made, judgement(), threads)
    return {**made, **more}


class WooDeyTest(unittest.TestCase):
    def test_drawn_points_keep_their_order_and_lose_their_normals(self):
        lines = [f"{number} 0 0 1 0 0" for number in range(100)]
        drawn = table_1.drawn(lines, 40)
        numbers = [int(line.split()[0]) for line in drawn]
        self.assertEqual((len(set(numbers)), numbers), (40, sorted(numbers)))
        self.assertEqual({line.split(maxsplit=1)[1] for line in drawn}, {"0 0"})
        self.assertEqual(drawn, table_1.drawn(lines, 40))

    def test_line_shows_the_two_filters_without_reading_and_measuring(self):
        line = table_1.our_line(entry())
        self.assertEqual(len(line), len(table_1.HEADER))
        self.assertEqual(line[-4:], ["0.50 / 0.50 s", "0.25 / 0.25 s", "0.75 / 0.75 s", "625.00 s"])
        self.assertEqual(line[2:8], ["12", "40", "16", "-4", "2", "3"])
        self.assertEqual(line[11:13], ["25 %", "5 %"])

    def test_printed_time_per_point(self):
        cloud = next(cloud for model in table_1.MODELS for cloud in model.clouds if cloud.points == 53570)
        line = table_1.printed_line(cloud)
        self.assertEqual(len(line), len(table_1.HEADER))
        self.assertEqual(line[-2:], ["388.80 s", "72.6 s"])

    def test_initial_cloud_has_no_printed_time(self):
        self.assertEqual(table_1.printed_line(table_1.MODELS[0].clouds[0])[3:], [""] * (len(table_1.HEADER) - 3))

    def test_runs_that_differ_are_refused(self):
        with self.assertRaisesRegex(scanmill.Broken, "different unused"):
            paper.take(entry(), judgement(unused=1), "1")

    def test_failed_run_is_a_failure_with_its_reason(self):
        made = entry()
        paper.take(made, table_1.judged(REPORT, {"outcome": "failed", "error": "too flat"}), "1")
        self.assertEqual(made["failure"], "too flat")
        self.assertIn("failed", table_1.our_line(made))

    def test_conclusion_names_what_differs_from_the_model(self):
        text = table_1.conclusion([entry(), entry(model_genus=3, doubtful=True)])
        self.assertIn("golf club (updated, 0 instead of 3)", text)
        self.assertIn("Doubtful: golf club (updated)", text)
        self.assertIn("1/518", text)  # 388.8 s over 0.75 s
        self.assertEqual(table_1.conclusion([entry(failure="crash")]), "Nothing ran.")

    def test_missing_models_are_failures(self):
        class Options:
            data, program, rounds = pathlib.Path("/nowhere"), "none", 1
        entries = table_1.run(Options, pathlib.Path("/nowhere"))["clouds"]
        self.assertEqual(len(entries), sum(len(model.clouds) for model in table_1.MODELS))
        self.assertTrue(all("make data" in one["failure"] for one in entries))


if __name__ == "__main__":
    unittest.main()
