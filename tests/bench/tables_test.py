# SPDX-License-Identifier: GPL-3.0-or-later
"""Running the program for a table, and writing the page."""
import json
import pathlib
import sys
import tempfile
import unittest

from tables import page, scanmill


def said(code, limit=60):
    """The report of a program that runs this line of Python."""
    return scanmill.report([sys.executable, "-c", code], limit)


class ReportTest(unittest.TestCase):
    def test_report_is_read_also_when_scans_failed(self):
        for status in (0, 1):
            self.assertEqual(said(f"print('{{\"cells\": []}}'); raise SystemExit({status})"), {"cells": []})

    def test_wrong_arguments_and_faults_are_no_report_even_with_json(self):
        for status in (2, 3):
            with self.assertRaisesRegex(scanmill.Broken, f"ended with {status}: no such filter"):
                said(f"import sys; print('{{}}'); print('no such filter', file=sys.stderr); sys.exit({status})")

    def test_killed_program_is_told_by_its_signal(self):
        with self.assertRaisesRegex(scanmill.Broken, "ended with -9"):
            said("import os; os.kill(os.getpid(), 9)")

    def test_endless_program_is_stopped(self):
        with self.assertRaisesRegex(scanmill.Broken, "did not end within 0.2 s"):
            said("import time; time.sleep(60)", limit=0.2)

    def test_what_is_no_json_and_what_cannot_be_started_is_told(self):
        with self.assertRaisesRegex(scanmill.Broken, "printed no JSON"):
            said("print('done')")
        with self.assertRaisesRegex(scanmill.Broken, "cannot be started: No such file"):
            scanmill.report(["/nowhere/scanmill"], 1)

    def test_program_is_told_to_keep_nothing_and_to_print_json(self):
        with tempfile.TemporaryDirectory() as folder:
            echo = pathlib.Path(folder) / "echo"
            echo.write_text(f"#!{sys.executable}\nimport json, sys\nprint(json.dumps(sys.argv[1:]))\n")
            echo.chmod(0o755)
            words = scanmill.run(echo, "w.yaml", ["a.ply", "b.ply"], "out", 60, threads=1, inputs={"truth": "t.ply"})
        self.assertEqual(words[:6], ["run", "w.yaml", "a.ply", "b.ply", "-o", "out"])
        for word in ("--no-cache", "--json", "truth=t.ply"):
            self.assertIn(word, words)
        self.assertEqual(words[words.index("--threads") + 1], "1")


class StepsTest(unittest.TestCase):
    def test_steps_are_those_of_the_cell_by_their_filters(self):
        report = {"steps": [{"facts": 1}, {"filter": "sculpt", "n": 1}, {"facts": 2}, {"filter": "sculpt", "n": 2}]}
        self.assertEqual(scanmill.steps(report, {"steps": [2, 3]}),
                         {"read": {"facts": 2}, "sculpt": {"filter": "sculpt", "n": 2}})

    def test_only_a_written_mesh_is_the_mesh(self):
        good = {"kind": "mesh", "outcome": "ok"}
        others = [{"kind": "tets", "outcome": "ok"}, {"kind": "mesh", "outcome": "skipped"}]
        self.assertIs(scanmill.mesh({"scan": "a", "outputs": [*others, good]}), good)
        with self.assertRaisesRegex(scanmill.Broken, "a: the workflow wrote 0 meshes"):
            scanmill.mesh({"scan": "a", "outputs": others})


class PageTest(unittest.TestCase):
    def test_bar_within_a_cell_does_not_end_it(self):
        self.assertEqual(page.table(["a"], [["b | c"]]), ["| a |", "| --- |", "| b \\| c |"])

    def test_json_and_page_appear_together_and_leave_nothing_else(self):
        with tempfile.TemporaryDirectory() as folder:
            page.write(pathlib.Path(folder) / "new", "results", {"a": 1}, ["# A", "", ""])
            made = {path.name: path.read_text() for path in (pathlib.Path(folder) / "new").iterdir()}
        self.assertEqual(made.keys(), {"results.json", "results.md"})
        self.assertEqual((json.loads(made["results.json"]), made["results.md"]), ({"a": 1}, "# A\n"))

    def test_every_element_of_a_list_has_a_line(self):
        results = {"a": 1, "b": [{"c": [1, 2]}, "d"], "e": []}
        self.assertEqual(json.loads(page.json_text(results)), results)
        self.assertIn('\n  {"c": [1, 2]},\n  "d"\n', page.json_text(results))

    def test_results_without_a_number_are_not_written(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaises(ValueError):
            page.write(folder, "results", {"a": [float("nan")]}, [])


if __name__ == "__main__":
    unittest.main()
