# SPDX-License-Identifier: GPL-3.0-or-later
"""How decimated meshes are judged, which results of other programs are kept, and what the page says."""
import pathlib
import sys
import tempfile
import types
import unittest
from unittest import mock

try:
    import numpy
except ImportError:
    raise unittest.SkipTest("needs numpy") from None

import decimate as bench
import decimate_judge
import decimate_page as page
from harness.row import Contender
from tables.scanmill import Broken

PROGRAM = [sys.executable, str(pathlib.Path(__file__).with_name("fake_program.py"))]
METRICS = {"triangles": 4.0, "self-intersections": 2.0, "hausdorff-lower": 0.0099, "hausdorff-upper": 0.01,
           "certified": True}


class JudgeTest(unittest.TestCase):
    def test_minimum_angle_of_each_triangle(self):
        points = [(0, 0, 0), (4, 0, 0), (0, 3, 0), (0, 4, 0), (2, 0, 12**0.5), (8, 0, 0)]
        triangles = [(0, 1, 2), (1, 3, 0), (0, 1, 4), (0, 1, 5), (0, 0, 1)]
        expected = [numpy.degrees(numpy.arcsin(0.6)), 45, 60, 0, 0]
        numpy.testing.assert_allclose(decimate_judge.minimum_angles(points, triangles), expected, atol=1e-12)

    def test_smallest_angle_is_found_at_every_corner(self):
        points = [(0, 0, 0), (10, 0, 0), (10, 1, 0)]
        smallest = numpy.degrees(numpy.arctan(0.1))
        angles = decimate_judge.minimum_angles(points, [(0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1)])
        numpy.testing.assert_allclose(angles, [smallest] * 4)

    def test_facts_come_from_the_metrics_and_the_angles(self):
        facts = decimate_judge.judged(METRICS, numpy.arange(11.0))
        self.assertEqual(facts, {"triangles": 4, "self_intersections": 2, "min_angle": 1.0, "lower": 0.0099,
                                 "upper": 0.01, "certified": True})

    def test_without_bounds_there_is_no_distance(self):
        facts = decimate_judge.judged({"triangles": 4.0, "self-intersections": 0.0}, numpy.full(4, 60.0))
        self.assertEqual(facts, {"triangles": 4, "self_intersections": 0, "min_angle": 60.0})

    def test_both_directions_are_certified_against_the_input(self):
        mesh = [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]
        with mock.patch.object(decimate_judge.scanmill, "measure", return_value=METRICS) as measure, \
                mock.patch.object(decimate_judge, "read", return_value=mesh):
            facts = decimate_judge.Judge("scanmill", 1, 60)("result.ply", "input.ply")
        self.assertEqual(measure.call_args.args[:3], ("scanmill", "result.ply", "input.ply"))
        self.assertIn("certify=true", measure.call_args.args[4])
        self.assertEqual((facts["upper"], facts["min_angle"]), (0.01, 45.0))


class PeerTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.truth = pathlib.Path(folder.name) / "input.ply"
        numpy.zeros((3, 3)).tofile(self.truth.parent / "fake.points")
        numpy.array([[0, 1, 2]], "u4").tofile(self.truth.parent / "fake.triangles")
        self.judged = []

    def peer(self, hash_of_input="a", work=None, judge=None):
        contender = Contender("fake", work or {"do": "answer", "with": {"seconds": 0.5}},
                              prepare={"do": "answer", "with": {}})
        shared = types.SimpleNamespace(options=types.SimpleNamespace(limit=20), command=lambda _: PROGRAM, versions={},
                                       judge=judge or self.judge)
        peer = bench.Peer(shared, contender, self.truth, hash_of_input)
        self.addCleanup(peer.close)
        return peer

    def judge(self, mesh, truth):
        self.judged.append((mesh.name, truth))
        return {"triangles": 1, "upper": 0.25}

    def test_written_mesh_is_judged(self):
        self.assertEqual(self.peer().evaluate(100), {"triangles": 1, "upper": 0.25, "seconds": 0.5})
        self.assertEqual(self.judged, [("fake.ply", self.truth)])

    def test_evaluations_are_kept_for_the_next_run(self):
        self.peer().evaluate(100)
        self.assertEqual(self.peer().known, {100: {"triangles": 1, "upper": 0.25, "seconds": 0.5}})

    def test_evaluations_of_another_input_or_other_work_are_not_used(self):
        self.peer().evaluate(100)
        self.assertEqual(self.peer(hash_of_input="b").known, {})
        self.assertEqual(self.peer(work={"do": "answer", "with": {"seconds": 1.0}}).known, {})

    def test_crash_is_recorded(self):
        self.assertIn("SIGSEGV", self.peer(work={"do": "crash"}).evaluate(100)["failure"])

    def test_program_is_started_again_after_a_failure(self):
        peer = self.peer(work={"do": "answer-once", "with": {"seconds": 0.5}})
        self.assertEqual([peer.evaluate(target).get("failure") for target in (3, 2, 1)], [None, "tired", None])

    def test_mesh_that_cannot_be_measured_is_a_failure(self):
        def refuse(mesh, truth):
            raise Broken("no triangle of area above 0")
        self.assertEqual(self.peer(judge=refuse).evaluate(4), {"failure": "no triangle of area above 0"})


def facts(triangles, upper=0.01, **more):
    return {"triangles": triangles, "upper": upper, "lower": upper, "certified": True, "min_angle": 20.0,
            "self_intersections": 0, **more}


def record(name="bunny", kind="scanned", failure="", **distances):
    """`distances`: ours, then the other program's, by share."""
    return {"name": name, "file": f"{name}.off", "kind": kind, "failure": failure, "diagonal": 2.0,
            "input": {"triangles": 75408, "min_angle": 40.0, "self_intersections": 1},
            "distances": [{"share": float(share[1:].replace("_", ".")), "ours": ours, "others": {"peer": other}}
                          for share, (ours, other) in distances.items()]}


class PageTest(unittest.TestCase):
    def rows(self, *records):
        return list(page.triangle_rows(records, ["peer"]))

    def test_ratio_is_ours_over_the_others(self):
        self.assertEqual(self.rows(record(s0_3=(facts(1000), facts(2000)))),
                         [["bunny (75,408)", "0.3 %", "0.5 %", "1,000", "2,000 (0.50)"]])

    def test_failure_has_no_ratio_and_a_reason(self):
        failed = record(s1=(facts(1000), {"failure": "crashed"}))
        self.assertEqual(self.rows(failed)[0][-1], "failed")
        self.assertEqual(list(page.remarks([failed])), ["- bunny at 1 %, peer: failed: crashed"])
        self.assertEqual(page.median_row("all", [failed], ["peer"])[-1], "")

    def test_our_failure_leaves_the_row_empty(self):
        failed = record(s1=({"failure": "refused"}, {}))
        self.assertEqual(self.rows(failed), [["bunny (75,408)", "1 %", "", "failed", ""]])
        self.assertEqual(list(bench.failures([failed])), ["bunny at 1.0 %: refused"])

    def test_medians_are_over_all_and_over_each_kind(self):
        records = [record(s1=(facts(100), facts(200)), s0_1=(facts(300), facts(400))),
                   record("fandisk", "mechanical", s1=(facts(300), facts(200)))]
        self.assertEqual([(row[0], row[-1]) for row in page.median_rows(records, ["peer"])],
                         [("**median ratio**", "**0.75**"), ("**median, scanned**", "**0.62**"),
                          ("**median, mechanical**", "**1.50**")])

    def test_distances_at_which_a_program_needs_fewer_are_listed(self):
        told = list(page.summary([record(s1=(facts(300), facts(200)), s0_1=(facts(100), facts(200)))], ["peer"]))
        self.assertEqual(told, ["- peer needs fewer triangles: bunny at 1 % (1.50)"])

    def test_bounds_that_are_far_apart_are_remarked(self):
        self.assertIn("more than 1 % apart",
                      " ".join(page.remarks([record(s1=(facts(100, certified=False), facts(100)))])))

    def test_angles_and_self_intersections_are_beside_those_of_the_input(self):
        rows = page.fact_rows([record(s1=(facts(1), facts(1, min_angle=22.25)))], ["peer"], "min_angle", ".1f")
        self.assertEqual(list(rows), [["bunny (75,408)", "1 %", "40.0", "20.0", "22.2"]])

    def test_medians_of_a_fact_are_over_all_and_over_each_kind(self):
        records = [record(s1=(facts(1, min_angle=30.0), facts(1, min_angle=10.0)), s0_1=(facts(1), {"failure": "x"})),
                   record("fandisk", "mechanical", s1=(facts(1), facts(1, min_angle=12.0)))]
        self.assertEqual(list(page.median_facts(records, ["peer"], "min_angle", ".1f")),
                         [["**median**", "", "**40.0**", "**20.0**", "**11.0**"],
                          ["**median, scanned**", "", "**40.0**", "**25.0**", "**10.0**"],
                          ["**median, mechanical**", "", "**40.0**", "**20.0**", "**12.0**"]])

    def test_missing_file_is_a_failure(self):
        gone = {"name": "dragon", "failure": "it is not there", "distances": []}
        self.assertEqual(list(bench.failures([gone])), ["dragon: it is not there"])
        self.assertEqual(page.of_model(gone), ["dragon: failed: it is not there"])


class PromiseTest(unittest.TestCase):
    def broken(self, **more):
        return bench.broken_promise(facts(100, upper=0.02, **more), {"self_intersections": 1}, share=1, diagonal=2.0)

    def test_largest_error_may_be_reached_but_not_exceeded(self):
        self.assertEqual(self.broken(), "")
        self.assertEqual(self.broken(lower=0.03), "its distance is at least 1.5 % of the diagonal")

    def test_no_self_intersections_may_be_added(self):
        self.assertEqual(self.broken(self_intersections=1), "")
        self.assertEqual(self.broken(self_intersections=2), "self-intersections: 2, in the input 1")


class ChosenTest(unittest.TestCase):
    def test_large_models_run_only_when_asked_for(self):
        names = [[model.name for model in bench.chosen(types.SimpleNamespace(models="", large=large))]
                 for large in (False, True)]
        self.assertEqual(set(names[1]) - set(names[0]), {"dragon"})

    def test_unknown_model_is_refused_with_the_names(self):
        with self.assertRaisesRegex(SystemExit, "no model 'bonny'; the models are bunny"):
            bench.chosen(types.SimpleNamespace(models="bonny", large=False))


if __name__ == "__main__":
    unittest.main()
