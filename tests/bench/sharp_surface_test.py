# SPDX-License-Identifier: GPL-3.0-or-later
"""The dihedral angles that sharp_surface.py compares, for wedges whose angle is known, and the goals of its page."""
import argparse
import pathlib
import tempfile
import unittest

from sharp_surface_page import lines_of, misses

try:
    import numpy
    import scipy  # noqa: F401

    import dihedral_judge
except ImportError:
    dihedral_judge = None
try:
    import sharp_surface
    import trimesh  # noqa: F401
except ImportError:
    sharp_surface = None


class Wedge:
    """Two half-planes that meet at the line y = 0, z = `height`; `degrees` is their dihedral angle, positive if convex.
    Outside is above."""

    def __init__(self, degrees, height=0.0):
        half = numpy.radians(degrees / 2)
        self.left = numpy.array([0, numpy.sin(half), numpy.cos(half)])  # the crease runs along x, so left is y > 0
        self.right = numpy.array([0, -numpy.sin(half), numpy.cos(half)])
        self.height = height

    def normals(self, points):
        return numpy.where(points[:, 1:2] > 0, self.left, self.right)

    def features(self, begin=0, end=10, corners=()):
        return {"polylines": [{"type": "crease", "closed": False,
                               "points": [[begin, 0, self.height], [end, 0, self.height]],
                               "left-normals": [self.left.tolist()], "right-normals": [self.right.tolist()]}],
                "corners": [list(corner) for corner in corners]}


@unittest.skipIf(dihedral_judge is None, "needs numpy and scipy")
class Angles(unittest.TestCase):
    def judged(self, found, true, lines=None, away=0.0):
        return dihedral_judge.judged(found, lines or found.features(), true, true.features(), away, 0.1, 0.5, 5)

    def test_the_sign_tells_convex_from_concave_and_does_not_depend_on_the_direction_of_the_line(self):
        for degrees in (90, -60):
            wedge = Wedge(degrees)
            features = wedge.features()
            points, rows = numpy.array([[5.0, 0, 0]]), numpy.array([0])
            found = dihedral_judge.angles(wedge, points, rows, features, 0.1)
            self.assertAlmostEqual(numpy.degrees(found[0]), degrees)
            line = features["polylines"][0]
            line["points"].reverse()
            line["left-normals"], line["right-normals"] = line["right-normals"], line["left-normals"]
            found = dihedral_judge.angles(wedge, points, rows, features, 0.1)
            self.assertAlmostEqual(numpy.degrees(found[0]), degrees)

    def test_equal_wedges_are_right(self):
        one = self.judged(Wedge(90), Wedge(90))
        self.assertAlmostEqual(one["length"], 10)
        self.assertEqual((one["near"], one["right"]), (1, 1))
        self.assertAlmostEqual(one["error"], 0)

    def test_the_largest_difference_decides(self):
        for degrees, right in ((86, 1), (94, 1), (84, 0), (96, 0), (-90, 0)):
            one = self.judged(Wedge(degrees), Wedge(90))
            self.assertEqual(one["right"], right, degrees)
            self.assertAlmostEqual(one["error"], abs(degrees - 90))

    def test_a_crease_that_is_far_or_absent_is_not_right(self):
        far = self.judged(Wedge(90, height=0.6), Wedge(90))
        self.assertEqual((far["near"], far["right"], far["error"]), (0, 0, None))
        near = self.judged(Wedge(90, height=0.4), Wedge(90))
        self.assertEqual((near["near"], near["right"]), (1, 1))
        absent = self.judged(Wedge(90), Wedge(90), lines={"polylines": [], "corners": []})
        self.assertEqual((absent["near"], absent["right"], absent["error"]), (0, 0, None))

    def test_half_a_crease_is_right_on_half_of_the_length(self):
        one = self.judged(Wedge(90), Wedge(90), lines=Wedge(90).features(0, 4.5))
        self.assertAlmostEqual(one["right"], 0.5, delta=0.01)

    def test_surroundings_of_ends_and_corners_do_not_count(self):
        true = Wedge(90)
        self.assertAlmostEqual(self.judged(true, true, away=2)["length"], 6, delta=0.1)
        features = true.features(corners=[(5, 0, 0)])
        one = dihedral_judge.judged(true, features, true, features, 2, 0.1, 0.5, 5)
        self.assertAlmostEqual(one["length"], 2, delta=0.1)
        nothing = self.judged(true, true, away=6)
        self.assertEqual((nothing["length"], nothing["right"]), (0, None))


def record(name="anchor_dense", noise=0.05, **parts):
    whole = {
        "run": {"outcome": "ok", "seconds": 20.0},
        "triangles": {"dense": 1000, "light": 100},
        "creases": {"edges": 50, "found": 0.95, "false": 0.05},
        "patches": {"loosened": 0.01, "straight-edges": 0, "refined": 1, "c1-jump": 1e-12, "inverted": 0,
                    "sign-violations": 0, "microseconds": 900.0},
        "alone": {"microseconds": 50.0},
        "light": {"rms": 0.03},
        "smooth": {"triangles": 9000, "closed": True, "pieces": 1, "cuts": 0, "rms": 0.03},
        "angles": {"length": 3.0, "near": 1.0, "right": 0.9, "error": 1.0},
    }
    for part, changes in parts.items():
        whole[part] = {**whole[part], **changes}
    return {"name": name, "noise": noise, **whole}


class Goals(unittest.TestCase):
    def test_values_at_the_limits_reach_all_goals(self):
        self.assertEqual(misses(record(creases={"found": 0.9, "false": 0.1})), [])

    def test_every_goal_can_be_missed(self):
        cases = [({"patches": {"loosened": 0.0101}}, "1.01 % loosened"), ({"patches": {"c1-jump": 1e-9}}, "c1-jump"),
                 ({"alone": {"microseconds": 100}}, "100 µs"), ({"smooth": {"closed": False}}, "not closed"),
                 ({"smooth": {"cuts": 2}}, "2 cuts"), ({"smooth": {"rms": 0.031}}, "rms 0.031"),
                 ({"creases": {"found": 0.89}}, "89.0 % of the creases"), ({"creases": {"found": None}}, "none"),
                 ({"creases": {"false": 0.11}}, "11.0 % elsewhere"),
                 ({"angles": {"right": 0.89}}, "89.0 % of the angles"),
                 ({"angles": {"right": None}}, "none of the angles")]
        for parts, words in cases:
            found = misses(record(**parts))
            self.assertEqual(len(found), 1, parts)
            self.assertIn(words, found[0])

    def test_organic_models_have_a_lower_limit_and_no_goals_for_creases(self):
        bad = {"creases": {"found": 0.0, "false": 1.0}}
        self.assertEqual(misses(record(name="hand", noise=0, patches={"loosened": 0.005}, **bad)), [])
        self.assertEqual(len(misses(record(name="hand", noise=0, patches={"loosened": 0.006}))), 1)

    def test_much_noise_has_no_goals_for_creases_and_angles(self):
        self.assertEqual(misses(record(noise=0.1, creases={"found": 0.0}, angles={"right": 0.0})), [])
        self.assertEqual(len(misses(record(noise=0, creases={"found": 0.0}, angles={"right": 0.0}))), 1)

    def test_a_failed_case_is_a_miss_and_a_row(self):
        failed = {"name": "hand", "noise": 0, "error": "ended with -11"}
        self.assertEqual(misses(failed), ["ended with -11"])
        on = {"processor": "P", "cores": 2, "memory_gibibytes": 4, "system": "S", "kernel": "K"}
        load = {"others_cores": 0.0, "stolen_cpu_seconds": 0.0, "took_seconds": 1.0}
        lines = lines_of({"command": "c", "date": "d", "machine": on, "revision": "r", "load": load,
                          "records": [failed, record()]})
        self.assertIn("- hand, noise 0 %: ended with -11", lines)
        self.assertIn("1 of 2 cases reach all goals.", lines)
        widths = {len(line.split("|")) for line in lines if line.startswith("| hand") or line.startswith("| anchor")}
        self.assertEqual(len(widths), 3, "one number of cells per table")


@unittest.skipIf(sharp_surface is None, "needs numpy, scipy and trimesh")
class Cases(unittest.TestCase):
    def test_a_program_that_fails_makes_a_row_with_its_error(self):
        with tempfile.TemporaryDirectory() as folder:
            options = argparse.Namespace(program=pathlib.Path("/bin/false"), limit=10, keep=False,
                                         workflows=pathlib.Path(folder))
            made = sharp_surface.record_of("hand", 0, {"file": "hand.off"}, pathlib.Path(folder), options)
        self.assertEqual((made["name"], made["noise"]), ("hand", 0))
        self.assertEqual(len(misses(made)), 1)
        self.assertIn("printed no JSON", made["error"])
        self.assertNotIn("/", made["error"], "pages name no folders")

    def test_reasons_are_one_line(self):
        cell = {"outcome": "failed", "error": {"message": "no surface fits\n  in step 'a-patch' (w.yaml:1:1)"}}
        self.assertEqual(sharp_surface.words_of(cell), "no surface fits")
        self.assertEqual(sharp_surface.words_of({"outcome": "skipped"}), "skipped")
        self.assertEqual(sharp_surface.words_of({"outcome": "doubtful"}), "")

    def test_the_median_edge_counts_every_edge_once(self):
        vertices = numpy.array([[0, 0, 0], [3, 0, 0], [0, 4, 0], [3, 4, 0]], float)
        self.assertEqual(sharp_surface.median_edge(vertices, numpy.array([[0, 1, 2], [1, 3, 2]])), 4)  # 3 3 4 4 5


if __name__ == "__main__":
    unittest.main()
