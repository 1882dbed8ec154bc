# SPDX-License-Identifier: GPL-3.0-or-later
"""Kinds as NumPy arrays: no copies, no changes, and what is refused."""
import copy
import pickle
import unittest

import numpy as np

import scanmill
from support import InFolder, cube, python, random_points, resident_megabytes


class Arrays(InFolder):
    def test_an_array_of_doubles_is_not_copied_and_becomes_read_only(self):
        array = np.random.default_rng(1).random((100, 3))
        points = scanmill.Points(array)
        self.assertTrue(np.shares_memory(array, points.positions))
        self.assertFalse(array.flags.writeable)
        with self.assertRaises(ValueError):
            array[0] = 0
        with self.assertRaises(ValueError):
            points.positions[0] = 0

    def test_copy_leaves_the_array_as_it_is(self):
        array = np.zeros((2, 3))
        array[1] = 1
        points = scanmill.Points(array, copy=True)
        array[1] = 7
        self.assertEqual(points.positions[1].tolist(), [1, 1, 1])

    def test_a_view_of_an_array_that_can_change_is_copied(self):
        array = np.arange(12.0).reshape(4, 3)
        points = scanmill.Points(array[:2])
        array[0] = 99
        self.assertEqual(points.positions[0].tolist(), [0, 1, 2])
        readonly = array.view()
        readonly.flags.writeable = False
        points = scanmill.Points(readonly)
        array[0] = 5
        self.assertEqual(points.positions[0].tolist(), [99, 99, 99])

    def test_indices_that_anybody_can_write_are_copied(self):
        triangles = cube().triangles.copy()
        view = triangles[:]
        mesh = scanmill.Mesh(cube().positions, triangles)
        view[0] = 4_000_000_000
        self.assertEqual(mesh.triangles.max(), 7)
        self.assertTrue(np.shares_memory(mesh.triangles, scanmill.Mesh(mesh.positions, mesh.triangles).triangles))

    def test_equal_types_of_another_name_are_no_way_to_write(self):
        numbers = np.arange(3, dtype=np.longlong)
        points = scanmill.Points(np.eye(3), {"number": numbers})
        numbers[0] = 99
        self.assertEqual(points.columns["number"][0], 0)

    def test_with_positions_keeps_columns_and_their_units(self):
        points = scanmill.Points(np.random.default_rng(1).random((200, 3)), unit="mm")
        thin = scanmill.voxel_thin(points, bin_size="0.3 mm")
        moved = thin.with_positions(thin.positions + 1)
        np.testing.assert_array_equal(moved.positions, thin.positions + 1)
        self.assertEqual((list(moved.columns), moved.unit), (list(thin.columns), "mm"))
        if "bin-size" in thin.columns:
            np.testing.assert_allclose(moved.in_unit("m").columns["bin-size"], thin.columns["bin-size"] / 1000)
        self.assertRefuses("positions; 3 were given", lambda: thin.with_positions(np.eye(3)))
        self.assertRefuses("NaN", lambda: thin.with_positions(thin.positions * np.nan))

    def test_arrays_that_are_not_row_by_row_or_of_another_type_are_converted(self):
        expected = np.arange(12.0).reshape(4, 3)
        for given in (
            np.asfortranarray(expected),
            np.arange(24.0).reshape(4, 6)[:, ::2] / 2,
            expected.astype(np.float32),
            expected.astype(np.int16),
            expected.astype(">f8"),
            expected.tolist(),
        ):
            self.assertEqual(scanmill.Points(given).positions.tolist(), expected.tolist())

    def test_wrong_shapes_and_types_are_refused(self):
        for given in (np.zeros(3), np.zeros((2, 2)), np.zeros((2, 3, 1)), np.zeros((2, 3), complex), np.full((2, 3), "a"), np.zeros((2, 3), object), None):
            with self.assertRaises(TypeError):
                scanmill.Points(given)
        masked = np.ma.masked_array(np.zeros((2, 3)), mask=True)
        self.assertRefuses("masked", lambda: scanmill.Points(masked), TypeError)
        for triangles in ([[0, 1]], [[0.0, 1, 2]], [[0, 1, -1]], [[0, 1, 2**32]], "abc"):
            with self.assertRaises(TypeError):
                scanmill.Mesh(np.eye(3), triangles)
        self.assertRefuses("8", lambda: scanmill.Mesh(np.eye(3), [[0, 1, 8]]))

    def test_nan_is_refused_or_dropped(self):
        rows = [[0, 0, np.nan], [1, 1, 1], [2, np.inf, 2], [3, 3, 3]]
        error = self.assertRefuses("2 of 4 points", lambda: scanmill.Points(rows))
        self.assertIn("invalid='drop'", error.hint)
        dropped = scanmill.Points(rows, {"number": np.arange(4)}, invalid="drop")
        self.assertEqual(dropped.positions.tolist(), [[1, 1, 1], [3, 3, 3]])
        self.assertEqual(dropped.columns["number"].tolist(), [1, 3])
        with self.assertRaises(ValueError):
            scanmill.Points(rows, invalid="keep")
        self.assertRefuses("1 of 3 vertices", lambda: scanmill.Mesh([[0, 0, 0], [1, 0, 0], [0, np.nan, 0]], [[0, 1, 2]]))

    def test_columns_keep_their_type_and_their_rows(self):
        columns = {
            "bytes": np.arange(4, dtype=np.uint8),
            "floats": np.ones((4, 2), np.float32),
            "long": np.array([2**62, -1, 0, 1]),
            "truth": np.array([True, False, True, False]),
        }
        points = scanmill.Points(np.arange(12.0).reshape(4, 3), columns)
        self.assertEqual([str(column.dtype) for column in points.columns.values()], ["uint8", "float32", "int64", "uint8"])
        for name, column in columns.items():
            np.testing.assert_array_equal(points.columns[name], column)
        for bad in (np.zeros(3), np.zeros((4, 2, 2)), np.full(4, "a"), np.zeros((4, 0)), np.zeros(4, complex), 1.0):
            with self.assertRaises(TypeError):
                scanmill.Points(np.zeros((4, 3)) + np.arange(4)[:, None], {"bad": bad})

    def test_coordinates_far_from_zero_are_exact_beside_an_origin(self):
        world = np.array([5e6, 4e5, 100.0]) + np.arange(12.0).reshape(4, 3) / 1024
        points = scanmill.Points(world)
        self.assertNotEqual(points.origin, (0, 0, 0))
        np.testing.assert_array_equal(points.world_positions, world)

    def test_unit_origin_and_frame(self):
        points = scanmill.Points(np.eye(3), unit="mm", origin=(1, 2, 3), frame="part")
        self.assertEqual((points.unit, points.origin, points.frame), ("mm", (1, 2, 3), "part"))
        metres = points.in_unit("m")
        self.assertEqual(metres.unit, "m")
        np.testing.assert_allclose(metres.world_positions, points.world_positions / 1000, rtol=1e-15)
        self.assertRefuses("'parsec'", lambda: scanmill.Points(np.eye(3), unit="parsec"))
        self.assertRefuses("not declared", lambda: scanmill.Points(np.eye(3)).in_unit("mm"))
        self.assertRefuses("'parsec'", lambda: points.in_unit("parsec"))
        for wrong in ({"origin": (0, 0, np.nan)}, {"unit": 3}, {"frame": None}, {"columns": {3: [1, 2, 3]}}):
            with self.assertRaises((TypeError, ValueError)):
                scanmill.Points(np.eye(3), **wrong)

    def test_three_and_a_half_million_points_are_not_copied(self):
        array = np.random.default_rng(1).random((3_500_000, 3))
        before = resident_megabytes()
        points = scanmill.Points(array)
        view = points.positions
        self.assertLess(resident_megabytes() - before, 10)  # the array has 84 MB
        self.assertTrue(np.shares_memory(array, view))
        kept = scanmill.crop(points, box=[-1, -1, -1, 2, 2, 2])
        before = resident_megabytes()
        self.assertEqual(kept.positions.shape, array.shape)
        self.assertLess(resident_megabytes() - before, 10)

    def test_arrays_outlive_their_values(self):
        def rows():
            return scanmill.voxel_thin(random_points(1000), bin_size=0.2).positions

        kept = rows()
        copies = [rows() for _ in range(20)]
        np.testing.assert_array_equal(kept, copies[-1])


class Kinds(InFolder):
    def test_a_mesh_has_its_triangles(self):
        mesh = cube()
        self.assertEqual(mesh.triangles.shape, (12, 3))
        self.assertEqual(mesh.triangles.dtype, np.uint32)
        self.assertEqual(mesh.properties["closed"], True)
        self.assertEqual(mesh.properties["genus"], 0)
        sharp = scanmill.Mesh(mesh.positions, mesh.triangles, sharp_edges=[[1, 0], [0, 1], [2, 0]])
        self.assertEqual(sharp.sharp_edges.tolist(), [[0, 1], [0, 2]])

    def test_tetrahedra(self):
        tets = scanmill.delaunay(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]))
        self.assertEqual(tets.cells.tolist(), [[0, 1, 2, 3]])
        self.assertEqual(tets.neighbours.tolist(), [[2**32 - 1] * 4])
        self.assertIsNone(tets.inside)
        with self.assertWarns(scanmill.DoubtWarning):  # points inside a ball are no surface
            solid = scanmill.alpha_solid(scanmill.delaunay(random_points(300)), alpha=1.0)
        labels = solid.outputs["tets"].inside
        self.assertEqual(set(labels.tolist()) - {0, 1}, set())

    def test_the_lines_of_features(self):
        features = scanmill.features(cube())
        self.assertEqual({line.type for line in features.lines}, {"crease"})
        self.assertEqual(sum(len(line.vertices) - (not line.closed) for line in features.lines), 12)
        self.assertEqual(len(features.corners), 8)
        for line in features.lines:
            self.assertTrue(np.shares_memory(line.vertices, features.vertices))
            self.assertEqual(line.positions.shape, (len(line.vertices), 3))

    def test_transforms_are_matrices(self):
        points = random_points(100)
        moved = scanmill.Points(points.positions + [1, 2, 3])
        motion = scanmill.align(points, moved)
        np.testing.assert_allclose(motion.matrices[0], [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]], atol=1e-9)
        again = scanmill.Transforms.from_document(motion.document())
        np.testing.assert_allclose(list(again), list(motion), atol=1e-15)
        np.testing.assert_allclose(scanmill.apply_transform(again, points).world_positions, moved.positions, atol=1e-9)

    def test_transforms_of_matrices(self):
        matrix = np.eye(4)
        matrix[:3, 3] = 1, 2, 3
        motion = scanmill.Transforms(matrix, ["a"], frame="b", unit="mm")
        np.testing.assert_array_equal(motion.matrices, [matrix])
        self.assertEqual(motion.names, [("a", "b")])
        self.assertRefuses("rotation", lambda: scanmill.Transforms(np.diag([2, 2, 2, 1])))
        with self.assertRaises(ValueError):
            scanmill.Transforms(np.eye(3))

    def test_kinds_that_only_filters_make(self):
        for kind in (scanmill.Tets, scanmill.Features, scanmill.Picture, scanmill.Value):
            with self.assertRaises(TypeError):
                kind(np.eye(3))

    def test_patches_and_pictures(self):
        patches = scanmill.a_patch(cube())
        self.assertEqual(patches.weights.shape, (len(patches.tets), 20))
        picture = cube().picture(size=[64, 48])
        self.assertEqual(picture.pixels.shape, (48, 64, 3))
        self.assertTrue(picture.png().startswith(b"\x89PNG"))
        self.assertTrue(cube()._repr_png_().startswith(b"\x89PNG"))
        self.assertIsNone(scanmill.delaunay(random_points(10))._repr_png_())

    def test_metrics_are_numbers(self):
        measured = scanmill.measure(cube(), cube())
        self.assertEqual(measured.kind, "metrics")
        self.assertEqual(measured.values["hausdorff-upper"] if "hausdorff-upper" in measured.values else 0, 0)
        self.assertIsInstance(measured.metrics, dict)

    def test_a_pickled_value_has_the_same_arrays(self):
        points = scanmill.Points(np.eye(3), {"weight": np.arange(3.0)}, unit="mm", frame="part", origin=(1, 2, 3))
        again = pickle.loads(pickle.dumps(points))
        self.assertEqual((again.unit, again.frame, again.origin), ("mm", "part", (1, 2, 3)))
        np.testing.assert_array_equal(again.positions, points.positions)
        np.testing.assert_array_equal(again.columns["weight"], points.columns["weight"])
        for value in (cube(), scanmill.delaunay(random_points(20)), scanmill.features(cube()), scanmill.measure(cube(), cube())):
            self.assertEqual(repr(pickle.loads(pickle.dumps(value))), repr(value))
        self.assertIs(copy.deepcopy(points), points)
        error = pickle.loads(pickle.dumps(scanmill.Error("a", ["b"], "c")))
        self.assertEqual((error.sentence, error.frames, error.hint), ("a", ("b",), "c"))

    def test_values_say_what_they_are(self):
        self.assertEqual(repr(cube()), "<scanmill.Mesh: 8 vertices, 12 triangles>")
        self.assertEqual(repr(scanmill.Points(np.eye(3), unit="mm")), "<scanmill.Points: 3 points, mm>")


class Files(InFolder):
    def test_what_is_written_is_read(self):
        scanmill.Points(np.eye(3), {"weight": np.arange(3.0)}, unit="mm").write("a.ply")
        again = scanmill.read("a.ply")
        np.testing.assert_array_equal(again.positions, np.eye(3))
        self.assertEqual(again.unit, "mm")
        scanmill.write(scanmill.features(cube()), "lines.json")
        self.assertEqual(len(scanmill.read("lines.json").corners), 8)
        with self.assertWarnsRegex(scanmill.ScanmillWarning, "unit mm"):
            other = scanmill.read("a.ply", unit="in", frame="lab")
        self.assertEqual((other.unit, other.frame), ("in", "lab"))

    def test_names_that_are_not_utf_8(self):
        name = b"q\xff.ply"
        cube().write(name)
        self.assertEqual(scanmill.read(name).kind, "mesh")
        self.assertRefuses("there is no such file", lambda: scanmill.read(b"no\xff.ply"))
        with self.assertWarns(scanmill.ScanmillWarning):
            scanmill.Mesh(cube().positions, cube().triangles, vertex_columns={"weight": np.arange(8.0)}).write(b"q\xff.stl")

    def test_what_a_format_cannot_hold_is_a_warning(self):
        with self.assertWarnsRegex(scanmill.ScanmillWarning, "STL"):
            scanmill.Mesh(cube().positions, cube().triangles, vertex_columns={"weight": np.arange(8.0)}).write("cube.stl")

    def test_files_that_cannot_be_read_or_written(self):
        self.assertRefuses("nothing.ply", lambda: scanmill.read("nothing.ply"))
        (self.folder / "bad.ply").write_bytes(b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000\n")
        self.assertRefuses("bad.ply", lambda: scanmill.read("bad.ply"))
        self.assertRefuses("mesh", lambda: cube().write("cube.xyzzy"))
        cube().write("cube.ply")
        self.assertRefuses("'cube.ply' contains mesh; expected tets", lambda: scanmill.read("cube.ply", kind="tets"))
        with self.assertWarnsRegex(scanmill.ScanmillWarning, "12 triangles"):
            self.assertEqual(scanmill.read("cube.ply", kind="points").kind, "points")
        self.assertRefuses("the kind is 'meshes'; expected points", lambda: scanmill.read("cube.ply", kind="meshes"))
        with self.assertRaises(TypeError):
            scanmill.write(np.eye(3), "a.ply")
        with self.assertRaises(ValueError):
            scanmill.read("cube.ply", invalid="keep")


class Names(unittest.TestCase):
    def test_the_package_imports_nothing_until_it_is_used(self):
        code = "import sys, scanmill; assert not {'numpy', 'scanmill._native'} & set(sys.modules), sys.modules.keys()"
        self.assertEqual(python(code).returncode, 0)

    def test_an_unknown_name_is_an_attribute_error_with_the_nearest(self):
        with self.assertRaisesRegex(AttributeError, "did you mean 'decimate'"):
            scanmill.decimat
        self.assertFalse(hasattr(scanmill, "_nothing"))
        self.assertIn("alpha_solid", dir(scanmill))


if __name__ == "__main__":
    unittest.main()
