# SPDX-License-Identifier: GPL-3.0-or-later
"""The true surfaces and the points on them; skipped without numpy and SciPy, which the benches bring along."""
import collections
import unittest

try:
    import numpy
    import sampling
    import shapes
    from scipy.spatial import cKDTree
except ImportError as error:
    raise unittest.SkipTest(f"{error.name} is not installed") from None

MADE = [shapes.sphere(3), shapes.torus(40, 16), shapes.block()]
VOLUMES = {"sphere": 4 / 3 * numpy.pi, "torus": 2 * numpy.pi**2 * 0.4**2, "block": 13}


def edges(shape):
    return collections.Counter((int(t[i]), int(t[(i + 1) % 3])) for t in shape.triangles for i in range(3))


def volume(shape):
    a, b, c = (shape.vertices[shape.triangles[:, i]] for i in range(3))
    return float(numpy.einsum("ij,ij->", a, numpy.cross(b, c)) / 6)


class ShapesTest(unittest.TestCase):
    def test_every_directed_edge_has_its_reverse_once(self):
        for shape in MADE:
            counted = edges(shape)
            self.assertTrue(all(counted[edge] == 1 and counted[edge[::-1]] == 1 for edge in counted), shape.name)

    def test_genus_is_that_of_euler(self):
        for shape in MADE:
            euler = len(shape.vertices) - len(edges(shape)) // 2 + len(shape.triangles)
            self.assertEqual(euler, 2 - 2 * shape.genus, shape.name)

    def test_volume_is_positive_and_near_the_closed_form(self):
        for shape in MADE:
            self.assertAlmostEqual(volume(shape) / VOLUMES[shape.name], 1, delta=0.05, msg=shape.name)
        self.assertAlmostEqual(volume(shapes.block()), 13)


class SamplingTest(unittest.TestCase):
    def test_points_keep_their_distance_and_leave_no_gap(self):
        for shape in MADE:
            points, spacing = sampling.spread(shape, 400, 1)
            nearest = cKDTree(points).query(points, 2)[0][:, 1]
            self.assertGreaterEqual(nearest.min(), spacing)
            places = sampling.uniform(shape, 5000, numpy.random.default_rng(2))
            self.assertLess(cKDTree(points).query(places)[0].max(), 1.5 * spacing)
            self.assertAlmostEqual(len(points) / 400, 1, delta=0.25)

    def test_seed_decides_and_nothing_else(self):
        one, again, other = (sampling.spread(MADE[0], 300, seed)[0] for seed in (1, 1, 2))
        self.assertTrue(numpy.array_equal(one, again))
        self.assertFalse(numpy.array_equal(one[:10], other[:10]))

    def test_noise_has_its_deviation_and_tells_the_farthest_move(self):
        points = numpy.zeros((20000, 3))
        moved, largest = sampling.with_noise(points, 0.5, 1)
        self.assertAlmostEqual(moved.std(), 0.5, delta=0.01)
        self.assertEqual(largest, numpy.linalg.norm(moved, axis=1).max())
        self.assertEqual(sampling.with_noise(points, 0, 1)[1], 0.0)


if __name__ == "__main__":
    unittest.main()
