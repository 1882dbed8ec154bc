# SPDX-License-Identifier: GPL-3.0-or-later
"""The known poses and the errors of registration.py, and its page."""
import pathlib
import tempfile
import unittest

try:
    import numpy
    import registration_page
    import registration_views as known
except ImportError:
    known = None


def grid(count=20):
    steps = numpy.arange(float(count))
    x, y = (axis.ravel() for axis in numpy.meshgrid(steps, steps))
    return numpy.stack([x, y, 0.1 * x * y], axis=1)


def some_views(count=4):
    points = [grid() + [3.0 * i, 0, 0] for i in range(count)]
    return known.Views([f"view-{i}" for i in range(count)], points, [numpy.array([0, 0, 1.0])] * count,
                       [numpy.eye(4)] * count, spacing=0.5, voxel=2.0)


@unittest.skipIf(known is None, "needs numpy")
class Errors(unittest.TestCase):
    def setUp(self):
        self.views = known.turned(some_views(), 7)
        self.common = known.matrix(known.rotation_of(1, 2, 3, 4), [5, 6, 7])
        self.found = {i: self.common @ pose for i, pose in enumerate(self.views.poses)}

    def test_known_poses_bring_turned_views_back(self):
        for turned, points, pose in zip(self.views.points, some_views().points, self.views.poses):
            self.assertGreater(numpy.abs(turned - points).max(), 1)
            self.assertLess(numpy.abs(known.moved(pose, turned) - points).max(), 1e-9)

    def test_same_seed_gives_the_same_views_and_another_one_others(self):
        again, other = known.turned(some_views(), 7), known.turned(some_views(), 8)
        self.assertTrue(numpy.array_equal(again.points[2], self.views.points[2]))
        self.assertFalse(numpy.array_equal(other.points[2], self.views.points[2]))

    def test_one_motion_of_all_poses_is_no_error(self):
        self.assertLess(max(known.errors_of(self.found, self.views, 0.5).values()), 1e-9)

    def test_one_wrong_view_leaves_the_others_right(self):
        self.found[1] = known.matrix(numpy.eye(3), [0, 0, 40]) @ self.found[1]
        errors = known.errors_of(self.found, self.views, 0.5)
        self.assertAlmostEqual(errors[1], 40 / 0.5)  # in spacings
        self.assertLess(max(errors[i] for i in (0, 2, 3)), 1e-9)

    def test_refused_views_have_no_error(self):
        del self.found[2]
        self.assertEqual(sorted(known.errors_of(self.found, self.views, 0.5)), [0, 1, 3])

    def test_a_mirrored_fit_is_not_a_motion(self):
        points = grid()
        self.assertAlmostEqual(numpy.linalg.det(known.fitted(points, points * [1, 1, -1])[:3, :3]), 1)


@unittest.skipIf(known is None, "needs numpy")
class Files(unittest.TestCase):
    def test_written_views_hold_the_direction_in_every_row(self):
        views = some_views(1)
        with tempfile.TemporaryDirectory() as folder:
            rows = known.read_columns(known.write(views, pathlib.Path(folder))[0])
        self.assertTrue(numpy.array_equal(numpy.stack([rows[axis] for axis in "xyz"], axis=1), views.points[0]))
        self.assertTrue((rows["nz"] == 1).all())


@unittest.skipIf(known is None, "needs numpy")
class Page(unittest.TestCase):
    def test_reasons_are_counted_by_their_word(self):
        starts = [{"reason": "'a' cannot be placed surely on the target (ambiguous): 90 %"}, {"reason": ""},
                  {"reason": "'b' cannot be placed surely on the target (slides): 10 %"}]
        self.assertEqual(registration_page.reasons_of([*starts, starts[0]]), "2 ambiguous, 1 slides")


if __name__ == "__main__":
    unittest.main()
