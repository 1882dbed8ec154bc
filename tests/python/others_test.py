# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of other packages, where those are installed."""
import importlib.util
import unittest

import numpy as np

import scanmill
from support import InFolder, cube, random_points


def needs(package):
    return unittest.skipUnless(importlib.util.find_spec(package), f"skipped: needs the package {package}")


class Trimesh(InFolder):
    @needs("trimesh")
    def test_there_and_back(self):
        mesh = scanmill.Mesh(cube(2).positions, cube().triangles, vertex_columns={"weight": np.arange(8.0)}, unit="mm")
        other = mesh.to_trimesh()
        self.assertEqual((other.is_watertight, other.volume, other.units), (True, 8.0, "mm"))
        again = scanmill.from_trimesh(other)
        np.testing.assert_array_equal(again.triangles, mesh.triangles)
        np.testing.assert_array_equal(again.vertex_columns["weight"], np.arange(8.0))
        self.assertEqual(again.unit, "mm")
        other.vertices += 1  # not those of the value
        self.assertEqual(mesh.positions.min(), 0)
        colours = np.arange(32, dtype=np.uint8).reshape(8, 4)
        coloured = scanmill.Mesh(cube().positions, cube().triangles, vertex_columns={"colour": colours}).to_trimesh()
        self.assertEqual(coloured.visual.kind, "vertex")
        np.testing.assert_array_equal(scanmill.from_trimesh(coloured).vertex_columns["colour"], colours)
        cloud = scanmill.from_trimesh(scanmill.to_trimesh(random_points(5)))
        np.testing.assert_array_equal(cloud.positions, random_points(5).positions)
        with self.assertRaises(TypeError):
            scanmill.from_trimesh(3)
        with self.assertRaises(TypeError):
            scanmill.to_trimesh(scanmill.delaunay(random_points(5)))


class Open3d(InFolder):
    @needs("open3d")
    def test_there_and_back(self):
        points = scanmill.Points(np.eye(3), {"normal": np.eye(3), "colour": np.array([[0, 127, 255]] * 3, np.uint8)})
        again = scanmill.from_open3d(scanmill.to_open3d(points), unit="mm")
        for name in ("normal", "colour"):
            np.testing.assert_array_equal(again.columns[name], points.columns[name])
        np.testing.assert_array_equal(again.positions, points.positions)
        mesh = scanmill.from_open3d(scanmill.to_open3d(cube()))
        np.testing.assert_array_equal(mesh.triangles, cube().triangles)
        with self.assertRaises(TypeError):
            scanmill.from_open3d(np.eye(3))


class Pyvista(InFolder):
    @needs("pyvista")
    def test_points_meshes_tetrahedra_and_lines(self):
        self.assertEqual(scanmill.to_pyvista(cube()).n_cells, 12)
        self.assertAlmostEqual(scanmill.to_pyvista(cube()).volume, 1)
        tets = scanmill.delaunay(random_points(50))
        self.assertEqual(scanmill.to_pyvista(tets).n_cells, len(tets.cells))
        self.assertEqual(scanmill.to_pyvista(random_points(7)).n_points, 7)
        mesh = cube()
        scanmill.to_pyvista(mesh).points[0] = 9  # not those of the value
        self.assertEqual(mesh.positions.max(), 1)
        features = scanmill.features(cube())
        self.assertEqual(scanmill.to_pyvista(features).n_lines, len(features.lines))


class Missing(InFolder):
    @unittest.skipIf(importlib.util.find_spec("trimesh"), "skipped: trimesh is installed")
    def test_a_missing_package_is_named(self):
        with self.assertRaisesRegex(ModuleNotFoundError, "pip install trimesh"):
            cube().to_trimesh()


if __name__ == "__main__":
    unittest.main()
