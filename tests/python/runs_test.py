# SPDX-License-Identifier: GPL-3.0-or-later
"""Workflows and batches from Python."""
import json
import os
import time
import unittest
import warnings
from pathlib import Path

import numpy as np

import scanmill
from support import InFolder, cube, interrupt_after, python, random_points

SHAPES = """\
scanmill: 1
steps:
  - virtual-scan: {shape: {sweep: [sphere, torus]}, resolution: 4 %diag}
outputs:
  "{variant}.ply": virtual-scan
"""
THIN = {"scanmill": 1, "inputs": {"scan": "points"}, "parameters": {"bin": {"default": "10 %diag", "help": "The bins."}}, "steps": [{"voxel-thin": {"bin-size": "$bin"}}], "outputs": {"{scan}.ply": "voxel-thin"}}


def read_bytes(file):
    try:
        return file.read_bytes()
    except OSError:
        return b""  # the process has ended


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
        self.assertRefuses("workflow:2:1: invalid YAML", lambda: self.run_quietly("steps: [\n"))
        self.assertRefuses("did you mean 'decimate'", lambda: self.run_quietly({"scanmill": 1, "steps": [{"decimat": None}]}))
        self.assertRefuses("ready workflow", lambda: self.run_quietly("nothing", random_points(5)))
        with self.assertRaises(TypeError):
            self.run_quietly(3)
        with self.assertRaises(TypeError):
            self.run_quietly(THIN, np.eye(3))
        self.assertRefuses("no parameter", lambda: self.run_quietly(THIN, random_points(50), parameters={"bins": 3}))

    def test_texts_are_taken_as_they_are(self):
        for text in (json.dumps(THIN, indent=1), f"---\n{SHAPES}...\n"):
            self.assertTrue(self.run_quietly(text, *([random_points(50)] if "voxel" in text else [])).ok)
        named = {**THIN, "parameters": {"my_bin": {"default": np.int64(1), "help": "The bins."}}, "steps": [{"voxel-thin": {"bin-size": "$my_bin"}}]}
        named["parameters"]["my_bin"]["default"] = "1 u"
        self.assertEqual(self.run_quietly(named, random_points(50), parameters={"my_bin": "0.5 u"}).cells[0].steps[1].parameters["bin-size"], "0.5 u")
        self.assertTrue(self.run_quietly({"scanmill": 1, "steps": [{"virtual-scan": {"shape": "sphere", "views": [np.int64(4)]}}], "outputs": {"a.ply": "virtual-scan"}}).ok)

    def test_the_working_folder_may_be_read_only(self):
        (self.folder / "fixed").mkdir(mode=0o500)
        os.chdir(self.folder / "fixed")
        try:
            result = self.run_quietly(THIN, random_points(50), output=self.folder / "out")
        finally:
            os.chdir(self.folder)
        self.assertTrue(result.ok)

    def test_values_keep_their_names_from_run_to_run(self):
        names = [self.run_quietly(THIN, random_points(50), output="out").cells[0].scan for _ in range(2)]
        self.assertEqual(names, ["out/inputs/scan.ply"] * 2)
        self.assertEqual([cell.scan for cell in self.run_quietly(THIN, (random_points(50) for _ in range(2)), output="two")], ["two/inputs/scan-1.ply", "two/inputs/scan-2.ply"])

    def test_names_that_look_like_options_or_lists(self):
        random_points(50).write("-dash.ply")
        self.assertTrue(self.run_quietly(THIN, "-dash.ply").ok)
        with self.assertRaisesRegex(ValueError, "comma"):
            self.run_quietly(THIN, inputs={"scan": "a,b.ply"})

    def test_a_run_that_cannot_be_recorded(self):
        (self.folder / "out").mkdir()
        (self.folder / "out/scanmill.sqlite").write_text("this is not a database")
        try:
            result = self.run_quietly(THIN, random_points(50), output="out")
        except scanmill.Error as error:
            self.assertIn("scanmill.sqlite", str(error))
        else:
            self.assertEqual(result.number, 0)

    def test_warnings_of_the_program_are_not_lost(self):
        with self.assertWarnsRegex(scanmill.ScanmillWarning, "cache"):
            scanmill.run(THIN, random_points(50), cache="/proc/nothing")

    def test_where_warnings_are_errors_the_result_is_theirs(self):
        points = scanmill.Points(np.random.default_rng(1).random((50, 3)), {"weight": np.arange(50.0)})
        stl = {**THIN, "steps": [*THIN["steps"], {"delaunay": None}, {"cocone": None}], "outputs": {"{scan}.stl": "cocone"}}
        with self.assertRaises(scanmill.ScanmillWarning) as caught:
            scanmill.run(stl, points, cache=False)
        self.assertEqual(caught.exception.result.cells[0].outputs[0].file.name, "scan.stl")

    def test_a_filter_that_breaks_its_declaration(self):
        if "test-step" not in scanmill.filters:
            self.skipTest("skipped: needs the filters of the C++ tests")
        broken = {"scanmill": 1, "inputs": {"scan": "points"}, "steps": [{"test-step": {"mode": "undeclared-metric"}}], "outputs": {"{scan}.ply": "test-step"}}
        result = self.run_quietly(broken, random_points(9), check=False)
        self.assertEqual((result.exit_code, result.cells[0].outcome), (3, "failed"))
        self.assertRefuses("does not declare", lambda: self.run_quietly(broken, random_points(9)))

    def test_a_run_ends_with_its_python(self):
        code = (
            "import scanmill, numpy, threading, os, signal, time\n"
            "points = scanmill.Points(numpy.random.default_rng(1).random((300_000, 3)))\n"
            "threading.Timer(1.5, lambda: os.kill(os.getpid(), signal.SIGKILL)).start()\n"
            "scanmill.run('raw-scans', points, output='out', cache=False)\n"
        )
        python(code)
        marker = str(self.folder / "out").encode()
        left = [1]
        for _ in range(50):
            left = [process for process in Path("/proc").glob("[0-9]*/cmdline") if marker in read_bytes(process)]
            if not left:
                break
            time.sleep(0.2)
        self.assertEqual(left, [])

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
