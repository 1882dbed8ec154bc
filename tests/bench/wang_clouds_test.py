# SPDX-License-Identifier: GPL-3.0-or-later
"""The clouds of Wang 2006 by their formulas, and what follows from the numbers that it prints."""
import math
import pathlib
import tempfile
import unittest

import paper_wang as paper
import wang_clouds as clouds


class CloudsTest(unittest.TestCase):
    def test_hemisphere_has_radius_and_no_step_wider_than_the_tolerance_allows(self):
        points = clouds.hemisphere(8, 0.025)
        widest = 2 * 8 * math.sin(clouds.step_of(8, 0.025) / 2)
        for point in points:
            self.assertAlmostEqual(math.hypot(*point), 8)
        nearest = [min(math.dist(a, b) for b in points if b != a) for a in points]
        self.assertLessEqual(max(nearest), widest + 1e-12)
        self.assertAlmostEqual(math.degrees(clouds.step_of(1, 0.005)), 11.464, places=3)

    def test_discs_are_counted_with_their_rim(self):
        # Gauss's circle problem: 1257 lattice points in the disc of radius 20, 7845 in that of radius 50.
        self.assertEqual((len(clouds.cone()), len(clouds.hyperboloid())), (1257, 7845))
        for x, y, z in clouds.hyperboloid():
            self.assertAlmostEqual(z * z, 0.5625 * (x * x - y * y + 4))

    def test_curvatures_of_the_hyperboloid_at_points_where_they_are_known(self):
        # In the middle both are a / r. On the rim at y = r, where z is 0, the section along x is the hyperbola
        # y² = r² + x², of curvature 1 / r there, and that along z the ellipse of half axes r and a r, of r / (a r)².
        for found, known in ((clouds.hyperboloid_curvatures((0, 0, 1.5)), (0.375, 0.375)),
                             (clouds.hyperboloid_curvatures((0, 2, 0)), (1 / (0.5625 * 2), 0.5))):
            for one, other in zip(found, known):
                self.assertAlmostEqual(one, other)

    def test_bin_sizes_follow_equation_3_14_both_ways(self):
        self.assertAlmostEqual(clouds.bin_size(0.25, 0.025), 0.51640, places=5)
        self.assertAlmostEqual(clouds.bin_size(0.125, 0.025), 0.73030, places=5)
        self.assertAlmostEqual(clouds.bending_of(1.2, 0.6), 1.1111, places=4)
        self.assertAlmostEqual(clouds.bending_of(clouds.bin_size(3, 0.1), 0.1), 3)

    def test_written_clouds_are_read_back_to_the_last_digit(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "cone.xyz"
            clouds.write(clouds.cone(), file)
            read = [tuple(float(word) for word in line.split()) for line in file.read_text().splitlines()]
        self.assertEqual(read, clouds.cone())


class PaperTest(unittest.TestCase):
    def test_boundary_edges_follow_from_what_was_printed(self):
        found = [paper.CASES[name].boundary_edges for name in ("face", "block", "rhino")]
        self.assertEqual(found, [119, 578, 308])
        self.assertIsNone(paper.CASES["hyperboloid"].boundary_edges)

    def test_bins_of_stand_ins_have_the_same_share_of_the_diagonal(self):
        self.assertAlmostEqual(paper.CASES["face"].bin_share, 1.2 / math.sqrt(45**2 + 64**2 + 15**2))

    def test_every_scan_has_a_stand_in(self):
        self.assertEqual({one.case for one in paper.STAND_INS} | {"hyperboloid", "block"}, set(paper.CASES))


if __name__ == "__main__":
    unittest.main()
