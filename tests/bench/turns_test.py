# SPDX-License-Identifier: GPL-3.0-or-later
"""Who works when, and what is recorded of it."""
import pathlib
import sys
import tempfile
import unittest

from harness import turns
from harness.inputs import Input, Inputs, Missing
from harness.row import Contender, Row, in_threads

PROGRAM = [sys.executable, str(pathlib.Path(__file__).with_name("fake_program.py"))]


def row(contenders, **more):
    values = {"name": "n", "title": "t", "inputs": [], "equal": "all", "agree": {"kept": 0.01}, **more}
    return Row(contenders=contenders, **values)


def answering(program, differs="", **facts):
    return Contender(program, {"do": "answer", "with": facts}, differs=differs)


def run(one, **options):
    return turns.run(one, lambda program: PROGRAM, turns.Options(**options))


class TurnsTest(unittest.TestCase):
    def test_contenders_work_in_turn_after_a_round_that_does_not_count(self):
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder) / "log"
            work = [Contender(name, {"do": "log", "file": str(log), "name": name}) for name in "AB"]
            record = run(row(work), rounds=2)
            self.assertEqual(log.read_text().split(), ["A", "B"] * 3)
        self.assertEqual([len(entry["seconds"]) for entry in record["contenders"]], [2, 2])

    def test_warm_up_is_the_first_round_and_no_other(self):
        entry = run(row([Contender("a", {"do": "count"})]), rounds=3)["contenders"][0]
        self.assertEqual((entry["warm_up_seconds"], entry["seconds"]), (1.0, [2.0, 3.0, 4.0]))
        self.assertEqual(entry["varied"], ["round"])

    def test_without_warm_up_the_first_round_counts(self):
        entry = run(row([Contender("a", {"do": "count"})], warm_up=False), rounds=2)["contenders"][0]
        self.assertEqual((entry["warm_up_seconds"], entry["seconds"]), (None, [1.0, 2.0]))

    def test_slow_contender_sits_out_after_two_counted_rounds(self):
        slow, quick = answering("slow", seconds=10.0, kept=1), answering("quick", seconds=0.1, kept=1)
        record = run(row([slow, quick]), rounds=5, budget=5.0)
        self.assertEqual([len(entry["seconds"]) for entry in record["contenders"]], [2, 5])

    def test_threads_are_sent_along(self):
        contenders = in_threads([1, 2], "a", {"do": "log", "file": "/dev/null", "name": "a"})
        record = run(row(contenders), rounds=1)
        self.assertEqual([entry["facts"]["threads"] for entry in record["contenders"]], [1, 2])

    def test_part_of_the_time_is_no_fact(self):
        entry = run(row([answering("a", seconds=1.0, building_seconds=0.5, kept=1)]), rounds=2)["contenders"][0]
        self.assertEqual((entry["facts"], entry["part_seconds"]), ({"kept": 1}, {"building": [0.5, 0.5]}))

    def test_failure_stops_nobody_else_and_keeps_its_reason(self):
        record = run(row([Contender("a", {"do": "crash"}), answering("b", seconds=1.0, kept=1)]), rounds=2)
        failed, fine = record["contenders"]
        self.assertEqual((failed["failure"], failed["seconds"]), ("killed by SIGSEGV: the last words", []))
        self.assertEqual((fine["failure"], fine["seconds"]), ("", [1.0, 1.0]))

    def test_failure_to_load_is_a_failure(self):
        contender = Contender("a", {"do": "count"}, prepare={"do": "answer", "with": {"failed": "no such file"}})
        self.assertEqual(run(row([contender]), rounds=1)["contenders"][0]["failure"], "no such file")

    def test_failure_in_a_later_round_is_one(self):
        contender = Contender("a", {"do": "answer-once", "with": {"seconds": 1.0, "kept": 1}})
        entry = run(row([contender]), rounds=2)["contenders"][0]
        self.assertEqual((entry["failure"], entry["warm_up_seconds"], entry["seconds"]), ("tired", 1.0, []))

    def test_missing_input_fails_the_row_and_nobody_works(self):
        inputs = Inputs("/nowhere", "/nowhere/made", sys.executable)
        record = run(row([answering("a", seconds=1.0)], inputs=[inputs.scan("bunny", "bunny.off")]), rounds=1)
        self.assertIn("/nowhere/bunny.off is not there", record["failure"])
        self.assertEqual(record["contenders"], [])

    def test_input_tells_its_counts(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "two"
            make = lambda where: where.with_suffix(".points").write_bytes(bytes(48))
            record = run(row([], inputs=[Input("two points", path, make)]))
        self.assertEqual(record["inputs"], [{"what": "two points", "points": 2}])

    def test_other_load_is_recorded(self):
        load = run(row([answering("a", seconds=1.0)]), rounds=1)["load"]
        self.assertGreaterEqual(load["others_cpu_seconds"], 0)
        self.assertGreater(load["took_seconds"], 0)


class AgreementTest(unittest.TestCase):
    def unequal(self, *contenders):
        return [entry["unequal"] for entry in run(row(list(contenders)), rounds=1)["contenders"]]

    def test_result_within_the_tolerance_is_equal(self):
        said = self.unequal(answering("a", seconds=1.0, kept=100), answering("b", seconds=1.0, kept=101))
        self.assertEqual(said, ["", ""])

    def test_result_beyond_it_is_told_with_numbers(self):
        said = self.unequal(answering("a", seconds=1.0, kept=100), answering("b", seconds=1.0, kept=102))
        self.assertEqual(said, ["", "kept is 102 where a has 100: 2 % apart, 1 % allowed"])

    def test_work_that_differs_by_nature_is_not_checked(self):
        other = answering("b", seconds=1.0, kept=5, differs="makes centroids")
        self.assertEqual(self.unequal(answering("a", seconds=1.0, kept=100), other), ["", ""])

    def test_contender_that_failed_is_no_reference(self):
        gone = Contender("a", {"do": "answer-once", "with": {"seconds": 1.0, "kept": 1}})
        said = self.unequal(gone, answering("b", seconds=1.0, kept=100), answering("c", seconds=1.0, kept=100))
        self.assertEqual(said, ["", "", ""])

    def test_contender_may_have_a_tolerance_of_its_own(self):
        rough = Contender("b", {"do": "answer", "with": {"seconds": 1.0, "kept": 110}}, agree={"kept": 0.2})
        self.assertEqual(self.unequal(answering("a", seconds=1.0, kept=100), rough), ["", ""])

    def test_both_that_were_compared_count_as_checked(self):
        record = run(row([answering("a", seconds=1.0, kept=1), answering("b", seconds=1.0, kept=1)]), rounds=1)
        self.assertEqual([entry["checked"] for entry in record["contenders"]], [1, 1])

    def test_something_where_there_should_be_nothing_is_unequal(self):
        said = self.unequal(answering("a", seconds=1.0, kept=0), answering("b", seconds=1.0, kept=1))
        self.assertIn("inf %", said[1])

    def test_fact_that_nobody_else_tells_leaves_it_unchecked(self):
        record = run(row([answering("a", seconds=1.0, kept=1), answering("b", seconds=1.0, other=1)]), rounds=1)
        self.assertEqual([entry["checked"] for entry in record["contenders"]], [0, 0])


if __name__ == "__main__":
    unittest.main()
