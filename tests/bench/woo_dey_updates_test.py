# SPDX-License-Identifier: GPL-3.0-or-later
"""The solids, lines and pages of woo_dey_updates.py, left_out_view.py and update_sweep.py."""
import pathlib
import tempfile
import unittest

try:
    import left_out_view
    import numpy
    import open3d  # noqa: F401
    import update_solids as solids
    import update_sweep
    import update_sweep_page
    import woo_dey_updates as updates
except ImportError:
    updates = None

needs_packages = unittest.skipIf(updates is None, "needs the packages of bench/peers/requirements.txt")


@needs_packages
class Solids(unittest.TestCase):
    def test_each_change_is_one_part_and_the_truth_has_the_known_topology(self):
        for example in updates.EXAMPLES:
            solid, parts = example.make()
            self.assertEqual(solid.genus(), 0, example.what)
            self.assertEqual(parts[0].truth.genus(), 1 if "through-hole" in example.what else 0, example.what)
            self.assertEqual(len(parts[0].truth.decompose()), 1, example.what)
            for part in parts:
                self.assertEqual(solids.face_components(part.changed().faces), 1, example.what)
                self.assertGreater(len(part.gone.faces), 0, example.what)

    def test_clouds_are_at_most_four_times_as_dense_as_models(self):
        # A margin below 9, where a cloud's spacing is a third of the model's edges. The rings only lower it.
        for example in updates.EXAMPLES:
            solid, parts = example.make()
            model = example.initial / solids.mesh_of(solid).area
            for part in parts:
                self.assertLess(example.cloud / len(parts) / part.changed().area, 4 * model, example.what)

    def test_through_hole_has_the_area_of_its_wall(self):
        _, parts = updates.block_and_hole()
        self.assertAlmostEqual(parts[0].changed().area / (2 * numpy.pi * 9 * 20), 1, delta=1e-3)

    def test_points_are_as_many_as_asked_and_on_the_solid(self):
        box = solids.box((1, 1, 1))
        points = updates.exactly(1_000, 6, lambda spacing, random: updates.spread(box, spacing, random))
        self.assertEqual(points.shape, (1_000, 3))
        self.assertAlmostEqual(numpy.abs(numpy.abs(points).max(axis=1) - 0.5).max(), 0, delta=1e-12)


@needs_packages
class Table(unittest.TestCase):
    def judgement(self, truth=None, **metrics):
        """The judgement of a run that returns a box with the given metrics."""
        box = solids.box((1, 1, 1))
        counts = {"initial": 7, "resampled": 2, "added": 3, "discarded": 4, "kept": 5, "unused-points": 0, "groups": 2,
                  "replaced": 1, **metrics}
        seconds = {metric: 0.5 for metric in updates.PHASES.values()}
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "updated.ply"
            write_mesh(file, box)
            report = {"steps": [{"filter": "mesh-update", "seconds": 3.0, "metrics": {**counts, **seconds}}],
                      "cells": [{"scan": "box", "outcome": "ok", "steps": [0],
                                 "outputs": [{"file": str(file), "kind": "mesh", "outcome": "ok"}]}]}
            case = updates.Prepared(file, [], truth or box, [], 1.0)
            return updates.judged(report, case)

    def test_line_shows_counts_and_seconds_of_both_rebuilds(self):
        entry = {"paper": "", "file": "a box", "failure": "", "ratio": 1.0, "local": {"file": "a box", "failure": ""}}
        for into in (entry, entry["local"]):
            for threads in ("1", "all"):
                updates.paper.take(into, self.judgement(), threads)
        line = updates.our_line(entry)
        self.assertEqual(len(line), len(updates.HEADER))
        self.assertEqual(line[1:8], ["7", "3", "2", "4", "8", "0", "0 (0)"])
        self.assertEqual(line[-3:], ["0.500 / 0.500 s", "3.000 / 3.000 s", "3.000 / 3.000 s"])
        self.assertIn("2 vertices were added", updates.sentences(entry)[0])
        entry["local"]["failure"] = "seam\nhint"
        self.assertEqual(updates.our_line(entry)[-1], "failed")
        self.assertIn("seam.", updates.sentences(entry)[0])

    def test_counts_that_do_not_add_up_are_a_failure(self):
        self.assertIn("add up", self.judgement(kept=6)["failure"])

    def test_wrong_euler_number_is_a_failure(self):
        self.assertIn("2 instead of 0", self.judgement(truth=solids.torus(500))["failure"])

    def test_printed_lines_have_the_papers_discarded_points(self):
        lines = [updates.printed_line(example) for example in updates.EXAMPLES if example.paper]
        self.assertEqual([line[4] for line in lines], ["422", "2,557", "382", "1,803", "3,353"])
        self.assertEqual({len(line) for line in lines}, {len(updates.HEADER)})

    def test_page_of_the_real_view(self):
        self.assertIn("skipped", left_out_view.lines({})[0])
        facts = {"mean": 0.5, "largest": 2.0, "recall": 0.75, "genus": 0}
        refused = {"cloud": "whole", "rebuild": "local", "outcome": "refused", "reasons": ["seam: here"]}
        text = "\n".join(left_out_view.lines({"model": facts, "updates": [refused]}))
        self.assertIn("0.5000 | 2.00 | 0.7500", text)
        self.assertIn("`local`: seam: here.", text)


@needs_packages
class Sweep(unittest.TestCase):
    def record(self, outcome, kind="smooth", reason=""):
        return {"index": 3, "model": "box", "kind": kind, "feature": "sphere", "added": True, "vertices": 8,
                "points": 400, "h": 0.5, "width": 9.0, "ratio": None, "sigma": 0.2, "shift": 0.1, "rim_offset": 0.1,
                "position": [1.0, 2.0, 3.0], "outcome": outcome, "reason": reason}

    def test_share_of_seams_is_that_of_each_origin_of_models(self):
        records = [self.record("right"), self.record("admissible", reason="seam: here"),
                   self.record("right", "tight cocone"), self.record("right", "tight cocone")]
        text = update_sweep_page.seams(records)
        self.assertIn("0 of 2 (0 %) of the models made by tight-cocone", text)
        self.assertIn("1 of 2 (50 %) of the other models", text)

    def test_page_lists_the_cases_that_are_not_right(self):
        machine = {"processor": "p", "cores": 1, "memory_gibibytes": 1, "system": "s", "kernel": "k"}
        load = {"others_cores": 0, "stolen_cpu_seconds": 0, "took_seconds": 1}
        results = {"date": "", "command": "", "revision": "", "machine": machine, "load": load, "seed": 7,
                   "rebuild": "whole", "missing": [],
                   "cases": [self.record("right"), self.record("wrong", reason="torn")]}
        rows = [line for line in update_sweep_page.lines_of(results, "update-sweep") if "torn" in line]
        self.assertEqual(len(rows), 1)
        self.assertIn("wrong in silence", rows[0])

    def test_refusals_are_admissible_only_for_the_reasons_of_the_case(self):
        def outcome(allowed, **cell):
            return update_sweep.outcome_of(None, {"outcome": "failed", **cell}, {}, allowed)["outcome"]

        seam = {"cause": "refused", "error": "seam: the new surface"}
        self.assertEqual(outcome(["seam"], **seam), "admissible")
        self.assertEqual(outcome([], **seam), "refused")
        self.assertEqual(outcome(["seam"], cause="fault", error="seam"), "crashed")


def write_mesh(file, mesh):
    """A mesh with the columns of mesh-update: all vertices of the model, all faces updated."""
    lines = ["ply", "format ascii 1.0", f"element vertex {len(mesh.vertices)}",
             *(f"property double {axis}" for axis in "xyz"), "property int source", f"element face {len(mesh.faces)}",
             "property list uchar int vertex_indices", "property uchar updated", "end_header"]
    lines += [" ".join(map(repr, map(float, place))) + " 0" for place in mesh.vertices]
    lines += [f"3 {a} {b} {c} 1" for a, b, c in mesh.faces]
    file.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    unittest.main()
