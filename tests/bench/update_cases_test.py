# SPDX-License-Identifier: GPL-3.0-or-later
"""The solids, cases and judge of update_sweep.py."""
import types
import unittest

try:
    import numpy
    import open3d  # noqa: F401
    import update_cases as cases
    import update_judge as judge
    import update_solids as solids
except ImportError:
    cases = None


@unittest.skipIf(cases is None, "needs the packages of bench/peers/requirements.txt")
class Solids(unittest.TestCase):
    def test_models_are_closed_with_the_volumes_of_their_formulas(self):
        pi = numpy.pi
        for mesh, euler, volume in ((solids.sphere(9_000), 2, 4 / 3 * pi * 50**3),
                                    (solids.ellipsoid(9_000, (50, 38, 28)), 2, 4 / 3 * pi * 50 * 38 * 28),
                                    (solids.torus(9_000), 0, 2 * pi**2 * 35 * 15**2),
                                    (solids.cylinder(9_000), 2, pi * 28**2 * 90),
                                    (solids.l_block(4_600), 2, 100 * 50 * 40 + 45 * 40 * 40),
                                    (solids.box_of_12(), 2, 100 * 70 * 45)):
            self.assertTrue(solids.is_closed(mesh))
            self.assertEqual(mesh.euler, euler)
            self.assertLess(abs(mesh.volume() / volume - 1), 3e-3)
        self.assertEqual(solids.plate_with_holes().euler, 2 - 2 * 5)

    def test_open_and_pinched_meshes_are_not_closed(self):
        box = solids.box_of_12()
        self.assertFalse(solids.is_closed(box.part(numpy.arange(11))))
        moved = box.vertices + 2 * numpy.abs(box.vertices).max(axis=0)
        both = solids.Mesh(numpy.concatenate([box.vertices, moved]), numpy.concatenate([box.faces, box.faces + 8]))
        self.assertTrue(solids.is_closed(both))
        pinched = numpy.where(both.faces == 8 + numpy.argmin(moved.sum(axis=1)),
                              numpy.argmax(box.vertices.sum(axis=1)), both.faces)
        self.assertFalse(solids.is_closed(solids.Mesh(both.vertices, pinched)))


@unittest.skipIf(cases is None, "needs the packages of bench/peers/requirements.txt")
class Cases(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.case, _ = cases.case_of(7, 0, {})

    def test_cloud_lies_on_the_truth_and_its_ring_on_the_model(self):
        cloud = self.case.cloud
        self.assertLess(cases.distances(self.case.truth, cloud.clean).max(), 1e-2 * cloud.spacing)
        ring = cloud.clean[cloud.ring > 0]
        self.assertLess(cases.distances(self.case.model.mesh, ring).max(), 1e-2 * cloud.spacing)
        self.assertGreater(cases.distances(self.case.model.mesh, cloud.clean).max(), 2 * cloud.spacing)

    def test_same_seed_gives_the_same_case(self):
        other, _ = cases.case_of(7, 0, {})
        self.assertEqual(other.facts(), self.case.facts())
        self.assertTrue(numpy.array_equal(other.cloud.points, self.case.cloud.points))

    def test_judge_accepts_the_truth_and_rejects_the_model(self):
        model, truth = self.case.model.mesh, self.case.truth
        added = numpy.full(len(model.vertices), 0)
        unchanged = judge.Result(model, added, numpy.ones(len(model.faces), bool))
        self.assertTrue(any("h away" in fault for fault in judge.faults(self.case, unchanged, 0)[0]))
        case = types.SimpleNamespace(**{**vars(self.case), "model": types.SimpleNamespace(mesh=truth)})
        right = judge.Result(truth, numpy.zeros(len(truth.vertices)), numpy.ones(len(truth.faces), bool))
        self.assertEqual(judge.faults(case, right, 0)[0], [])


if __name__ == "__main__":
    unittest.main()
