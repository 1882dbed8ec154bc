# SPDX-License-Identifier: GPL-3.0-or-later
"""From a paper's runs to its page: what is written, and how it ends."""
import argparse
import contextlib
import io
import json
import pathlib
import tempfile
import unittest

from tables import paper, scanmill


class PaperTest(unittest.TestCase):
    def written(self, run):
        """What the bench ends with, says, and writes."""
        with tempfile.TemporaryDirectory() as folder:
            options = argparse.Namespace(rounds=3, into=pathlib.Path(folder))
            said = io.StringIO()
            with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
                try:
                    end = paper.write("t", options, run, lambda results: [f"{results['rounds']} rounds"], tried="cases")
                except SystemExit as exit_:
                    end = exit_.code
            files = {path.name: path.read_text() for path in pathlib.Path(folder).iterdir()}
            return end, said.getvalue(), files

    def test_page_and_results_are_written_and_failures_end_with_1(self):
        entries = [{"file": "a", "failure": ""}, {"file": "b", "failure": "is not there"}]
        end, said, files = self.written(lambda options, folder: {"cases": entries, "more": 5})
        self.assertEqual((end, files["t.md"]), (1, "3 rounds\n"))
        results = json.loads(files["t.json"])
        self.assertEqual((results["cases"], results["more"], results["rounds"]), (entries, 5, 3))
        self.assertIn("error: b: is not there", said)
        self.assertNotIn("error: a", said)

    def test_without_failures_it_ends_with_0(self):
        self.assertEqual(self.written(lambda options, folder: {"cases": [{"file": "a", "failure": ""}]})[0], 0)

    def test_broken_program_writes_nothing(self):
        def run(options, folder):
            raise scanmill.Broken("gone")

        self.assertEqual(self.written(run), ("error: gone", "", {}))


if __name__ == "__main__":
    unittest.main()
