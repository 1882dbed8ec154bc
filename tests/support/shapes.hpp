// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Meshes whose every number is known in closed form, for any test: closed, oriented outwards, no vertex twice.
///
/// Their properties (Euler characteristic, area, volume, radii) are asserted in tests/core/shapes_test.cpp. Order of
/// vertices and triangles is fixed, positions use only exactly rounded operations where no angle is involved.

#include <initializer_list>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill::test {

/// [0, edge]³; 8 vertices, 12 triangles.
TriangleMesh cube(double edge = 1);

/// The surface of the cube from 0 to `squares`, as unit squares of two triangles each.
TriangleMesh cube_of_squares(int squares);
/// Centred at 0; edge length as given; 4 vertices, 4 triangles. Area √3 edge², volume edge³ / (6 √2).
TriangleMesh regular_tetrahedron(double edge = 1);
/// Centred at 0; 12 vertices on the sphere of `radius`, 20 equal triangles.
TriangleMesh icosahedron(double radius = 1);
/// The icosahedron with every edge cut in `frequency` parts, its vertices pushed out to the sphere of `radius` around
/// 0: 10 frequency² + 2 vertices, 20 frequency² triangles. Area and volume approach the sphere's from below.
TriangleMesh geodesic_sphere(double radius, u32 frequency);
/// Around the z axis, centred at 0: `major` from the axis to the tube's centre, `minor` the tube's radius; `around`
/// times `along` vertices on the torus, twice as many triangles, genus 1. Pre: both at least 3, 0 < minor < major.
TriangleMesh torus(double major, double minor, u32 around, u32 along);
/// [0, 2]² × [0, 1] without the quadrant [1, 2]² × [0, 1], times `size`: 12 vertices, 20 triangles, area 14 size²,
/// volume 3 size³, one reflex edge of length `size`.
TriangleMesh l_block(double size = 1);

/// The same triangles without those in `rows`: makes open meshes. Vertices stay.
TriangleMesh without_triangles(const TriangleMesh& mesh, std::initializer_list<u32> rows);

double area(const TriangleMesh& mesh);
/// By the divergence theorem; positive for outward triangles. Meaningful for closed meshes.
double signed_volume(const TriangleMesh& mesh);

/// A cloud of just these positions, unit unknown, no columns.
PointCloud cloud_of(std::initializer_list<Vec3> positions);
/// The mesh's vertices with its vertex columns, in the mesh's frame.
PointCloud vertices_of(const TriangleMesh& mesh);
/// `count` seeded points, uniform in [0, edge)³.
PointCloud random_cube(std::size_t count, std::uint64_t seed, double edge = 1);
/// 500 points in the unit square, up to `thickness` above it.
PointCloud flat_square(double thickness);
/// `count` seeded points, uniform on the sphere of `radius` around 0.
PointCloud random_sphere(std::size_t count, std::uint64_t seed, double radius = 1);

}  // namespace scanmill::test
