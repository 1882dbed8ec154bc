# SPDX-License-Identifier: GPL-3.0-or-later
"""Workflows and batches from Python."""
import time
import unittest
import warnings
from pathlib import Path

import numpy as np

import scanmill
from support import InFolder, cube, interrupt_after, random_points

SHAPES = """\
scanmill: 1
steps:
  - virtual-scan: {shape: {sweep: [sphere, torus]}, resolution: 4 %diag}
outputs:
  "{variant}.ply": virtual-scan
"""
THIN = {"scanmill": 1, "inputs": {"scan": "points"}, "parameters": {"bin": {"default": "10 %diag", "help": "The bins."}}, "steps": [{"voxel-thin": {"bin-size": "$bin"}}], "outputs": {"{scan}.ply": "voxel-thin"}}


class Runs(InFolder):
    def run_quietly(self, *args, **kwargs):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", scanmill.ScanmillWarning)
            return scanmill.run(*args, cache=False, **kwargs)

    def test_a_workflow_is_a_text_a_dict_a_file_or_a_name(self):
        (self.folder / "shapes.yaml").write_text(SHAPES)
        for workflow in (SHAPES, "shapes.yaml", self.folder / "shapes.yaml"):
            result = self.run_quietly(workflow)
            self.assertTrue(result.ok)
            self.assertEqual([cell.variant for cell in result], ["shape=sphere", "shape=torus"])
            self.assertEqual([output.file.name for cell in result for output in cell.outputs], ["shape=sphere.ply", "shape=torus.ply"])
        self.assertEqual([path.name for path in self.folder.glob("workflow-*")], [])
        self.assertEqual(self.run_quietly("virtual-scans", cube(), parameters={"noise": "0.1 %diag"}).name, "virtual-scans")

    def test_results_are_objects_and_rows(self):
        result = self.run_quietly(SHAPES, output="out")
        cell = result.cells[0]
        self.assertEqual(cell.outputs[0].read().kind, "points")
        self.assertEqual(cell.steps[0].filter, "virtual-scan")
        self.assertIn("virtual-scan.points", cell.metrics)
        table = result.table()
        self.assertEqual([row["outcome"] for row in table], ["ok", "ok"])
        self.assertEqual(table[0]["virtual-scan.points"], len(cell.outputs[0].read()))
        self.assertIn("<td>shape=torus</td>", result._repr_html_())
        self.assertIn("2 ok", repr(result))

    def test_scans_may_be_values(self):
        points = scanmill.Points(np.random.default_rng(1).random((500, 3)), {"weight": np.arange(500.0)}, unit="mm")
        result = self.run_quietly(THIN, points, parameters={"bin": "300 um"})
        thinned = result.cells[0].outputs[0].read()
        np.testing.assert_array_equal(thinned.positions, scanmill.voxel_thin(points, bin_size="0.3 mm").positions)
        self.assertEqual(thinned.unit, "mm")
        self.assertIn("weight", thinned.columns)
        self.assertEqual(len(self.run_quietly(THIN, [points, points])), 2)

    def test_progress_and_events(self):
        fractions, events = [], []
        self.run_quietly(SHAPES, progress=fractions.append, on_event=events.append)
        self.assertEqual(fractions, sorted(set(fractions)))
        self.assertEqual(fractions[-1], 1.0)
        self.assertEqual((events[0]["event"], events[-1]["event"]), ("run-started", "run-ended"))

    def test_warnings_and_doubts_are_pythons_own(self):
        (self.folder / "cube.yaml").write_text("scanmill: 1\ninputs:\n  scan: mesh\nsteps:\n  - edge-flip:\noutputs:\n  '{scan}.stl': edge-flip\n")
        flipped = scanmill.Mesh(cube().positions, cube().triangles[:, ::-1])
        with self.assertWarnsRegex(scanmill.DoubtWarning, "inside out"):
            result = scanmill.run("cube.yaml", flipped, cache=False)
        self.assertEqual(result.cells[0].outcome, "doubtful")
        self.assertTrue(result.ok)

    def test_a_failed_cell_is_an_error_unless_it_is_not_checked(self):
        error = self.assertRefuses("there is no such file", lambda: self.run_quietly(THIN, "nothing.ply"))
        self.assertEqual(error.run.cells[0].outcome, "failed")
        result = self.run_quietly(THIN, ["nothing.ply", random_points(100)], check=False)
        self.assertEqual([cell.outcome for cell in result], ["failed", "ok"])
        self.assertFalse(result.ok)
        self.assertIn("no such file", result.cells[0].error)

    def test_workflows_that_do_not_parse(self):
        self.assertRefuses("workflow:4:1: invalid YAML", lambda: self.run_quietly("steps: [\n"))
        self.assertRefuses("did you mean 'decimate'", lambda: self.run_quietly({"scanmill": 1, "steps": [{"decimat": None}]}))
        self.assertRefuses("ready workflow", lambda: self.run_quietly("nothing", random_points(5)))
        with self.assertRaises(TypeError):
            self.run_quietly(3)
        with self.assertRaises(TypeError):
            self.run_quietly(THIN, np.eye(3))
        self.assertRefuses("no parameter", lambda: self.run_quietly(THIN, random_points(50), parameters={"bins": 3}))

    def test_ctrl_c_stops_a_run(self):
        times = []
        with self.assertRaises(KeyboardInterrupt), interrupt_after(1.0, times):
            self.run_quietly("raw-scans", random_points(200_000))
        print(f"\n  stopped after {time.perf_counter() - times[0]:.3f} s", end=" ")
        children = [pid for task in Path("/proc/self/task").iterdir() for pid in (task / "children").read_text().split()]
        self.assertEqual(children, [])

    def test_an_exception_of_the_callback_stops_the_run(self):
        def stop(event):
            raise LookupError

        with self.assertRaises(LookupError):
            self.run_quietly(SHAPES, on_event=stop)


class Batches(InFolder):
    def test_a_batch_with_a_gate(self):
        random_points(500).write("a.ply")
        (self.folder / "thin.yaml").write_text("scanmill: 1\ninputs:\n  scan: points\nsteps:\n  - voxel-thin: {bin-size: 20 %diag}\noutputs:\n  '{scan}.ply': voxel-thin\n")
        library = {"scanmill": 1, "scans": ["*.ply"], "workflows": ["thin.yaml"]}
        first = scanmill.batch(library, output="out", cache=False)
        self.assertTrue(first.ok)
        self.assertEqual(first.number, 1)
        self.assertEqual(scanmill.batch(library, output="out", scans="a.ply", cache=False).number, 2)
        self.assertRefuses("batch", lambda: scanmill.batch({"scanmill": 1, "scanz": []}))
        self.assertRefuses("not a batch", lambda: scanmill.batch("thin.yaml"))


if __name__ == "__main__":
    unittest.main()
