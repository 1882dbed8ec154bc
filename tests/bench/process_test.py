# SPDX-License-Identifier: GPL-3.0-or-later
"""A program that answers is asked; one that does not fails with a reason."""
import pathlib
import signal
import sys
import unittest

from harness.process import Failure, Process

PROGRAM = [sys.executable, str(pathlib.Path(__file__).with_name("fake_program.py"))]
LONG = 600.0  # seconds, for answers that come at once on a machine that is not overloaded


class ProcessTest(unittest.TestCase):
    def setUp(self):
        self.process = Process(PROGRAM)
        self.addCleanup(self.process.close)

    def failure(self, request, limit=LONG):
        with self.assertRaises(Failure) as caught:
            self.process.time(request, limit)
        return str(caught.exception)

    def answered(self, **facts):
        return {"do": "answer", "with": facts}

    def test_answer_arrives_as_it_was_given(self):
        self.assertEqual(self.process.time(self.answered(seconds=0.5, kept=7), LONG), {"seconds": 0.5, "kept": 7})

    def test_two_requests_get_their_own_answers(self):
        self.assertEqual(self.process.time(self.answered(seconds=1), LONG)["seconds"], 1)
        self.assertEqual(self.process.time(self.answered(seconds=2), LONG)["seconds"], 2)

    def test_exception_fails_with_its_text(self):
        self.assertEqual(self.failure(self.answered(failed="ValueError: too few points")), "ValueError: too few points")

    def test_signal_fails_with_its_name_and_the_last_words(self):
        self.assertEqual(self.failure({"do": "crash"}), "killed by SIGSEGV: the last words")

    def test_exit_fails_with_its_code(self):
        self.assertEqual(self.failure({"do": "exit"}), "ended with 1: it is over")

    def test_program_that_is_gone_fails_again(self):
        self.failure({"do": "exit"})
        self.assertEqual(self.failure(self.answered(seconds=1)), "ended with 1: it is over")

    def test_hanging_fails_at_the_time_limit(self):
        self.assertEqual(self.failure({"do": "hang"}, limit=0.2), "no answer within 0.2 s")
        self.assertEqual(self.process.process.returncode, -signal.SIGKILL)

    def test_words_that_are_no_json_fail(self):
        self.assertIn("which is not a JSON object", self.failure({"do": "mumble"}))

    def test_time_that_is_none_fails(self):
        for wrong in (None, 0, -1.0, "soon", float("nan"), float("inf")):
            self.assertIn("which is not a valid time", self.failure(self.answered(seconds=wrong)))

    def test_missing_program_fails_with_its_path(self):
        with self.assertRaisesRegex(Failure, "/nowhere/at/all cannot be started: No such file"):
            Process(["/nowhere/at/all"])

    def test_peak_counts_what_was_held_since_the_reset(self):
        self.process.ask({"do": "hold", "mebibytes": 64}, LONG)
        self.process.ask({"do": "release"}, LONG)
        self.assertGreater(self.process.peak_mebibytes(), 64)
        if not self.process.reset_peak():
            self.skipTest("skipped: this system does not let a process's peak be reset")
        self.assertLess(self.process.peak_mebibytes(), 64)


if __name__ == "__main__":
    unittest.main()
