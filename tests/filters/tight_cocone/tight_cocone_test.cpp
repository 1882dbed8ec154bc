// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes of known topology and volume, whole and with parts missing.

#include <Eigen/Geometry>
#include <array>
#include <set>

#include "filters/tight_cocone/cases.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;

constexpr double pi = std::numbers::pi;

TEST(TightCocone, Sphere_IsTheHullOfItsPoints) {
    const PointCloud cloud = fibonacci_sphere(2000, 1e-6);
    const TightCoconeResult result = closed_through(cloud);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(result.mesh.triangles.size(), 2 * 2000u - 4);
    EXPECT_EQ(result.unused, 0u);
    EXPECT_EQ(result.poor, 0u);
    EXPECT_EQ(std::ranges::count(result.tets.inside, u8(1)), static_cast<long>(result.tets.cells.size()));
    EXPECT_NEAR(volume(result.mesh), inside_volume(result.tets), 1e-9);
    EXPECT_EQ(result.invented_area, 0);
}

TEST(TightCocone, Torus_HasItsVolumeAndOneHandle) {
    const PointCloud cloud = poisson_torus(0.06);
    const TightCoconeResult result = closed_through(cloud);
    const MeshTopology found = topology(result.mesh);
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.euler, 0);
    EXPECT_EQ(found.triangles, 2 * cloud.positions.size());
    EXPECT_NEAR(volume(result.mesh), 2 * pi * pi * 0.16, 0.01 * 2 * pi * pi * 0.16);
}

TEST(TightCocone, SphereWithoutACap_IsClosed) {
    const double limit = std::cos(20 * pi / 180);
    const PointCloud cloud = points_where(fibonacci_sphere(2000, 1e-6), [&](const Vec3& p) { return p.z() < limit; });
    const TightCoconeResult result = closed_through(cloud);
    const MeshTopology found = topology(result.mesh);
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.euler, 2);
    EXPECT_EQ(result.holes_filled, 1u);
    // A flat cap, or more.
    const double height = 1 - limit, cap = pi * height * height * (3 - height) / 3;
    EXPECT_GT(volume(result.mesh), 0.99 * (4 * pi / 3 - cap));
    EXPECT_LT(volume(result.mesh), 4 * pi / 3);
    // The cap's area as a flat disc, to a ring of triangles.
    EXPECT_NEAR(result.invented_area, pi * std::sin(20 * pi / 180) * std::sin(20 * pi / 180), 0.08);
}

TEST(TightCocone, TwoSpheres_AreTwoComponents) {
    const PointCloud one = fibonacci_sphere(800, 1e-6);
    const TightCoconeResult result = closed_through(joined(one, moved(one, 1, Vec3(3, 0.2, 0.1))));
    const MeshTopology found = topology(result.mesh);
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.components, 2u);
    EXPECT_NEAR(volume(result.mesh), 8 * pi / 3, 0.1);
}

TEST(TightCocone, SphereInASphere_IsInsideTheSolid) {
    const PointCloud outer = moved(fibonacci_sphere(3000, 1e-6), 2), inner = fibonacci_sphere(800, 1e-6);
    const TightCoconeResult result = closed_through(joined(outer, inner));
    EXPECT_EQ(topology(result.mesh).components, 1u);
    EXPECT_EQ(result.removed_blobs, 1u);
    EXPECT_EQ(result.unused, 800u);
    EXPECT_NEAR(volume(result.mesh), 32 * pi / 3, 0.3);
}

TEST(TightCocone, Octahedron_IsItsEightTriangles) {
    // Its six points are on one sphere, so its four cells are a tie. Squares of edge sqrt(2) in the middle.
    const TightCoconeResult result =
        closed_through(cloud_of({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}));
    expect_promised(result, 6);
    EXPECT_EQ(result.mesh.triangles.size(), 8u);
    EXPECT_NEAR(volume(result.mesh), 4.0 / 3, 1e-12);
    EXPECT_NEAR(result.area, 4 * std::sqrt(3.0), 1e-12);
    EXPECT_EQ(result.good, 6u);
    EXPECT_EQ(result.invented_area, 0);
    // Each triangle is in one octant.
    std::set<std::array<bool, 3>> octants;
    for (const auto& [a, b, c] : result.mesh.triangles) {
        const Vec3 sum = result.mesh.positions[a] + result.mesh.positions[b] + result.mesh.positions[c];
        EXPECT_EQ(sum.cwiseAbs(), Vec3(1, 1, 1));
        octants.insert({sum.x() > 0, sum.y() > 0, sum.z() > 0});
    }
    EXPECT_EQ(octants.size(), 8u);
}

TEST(TightCocone, Cube_IsItsTwelveTriangles) {
    // Every four corners of a face are on one circle, and all eight on one sphere.
    const TightCoconeResult result = closed_through(lattice_cube(1));
    expect_promised(result, 8);
    EXPECT_EQ(result.mesh.triangles.size(), 12u);
    EXPECT_NEAR(volume(result.mesh), 1, 1e-12);
    EXPECT_NEAR(result.area, 6, 1e-12);
    EXPECT_EQ(result.unused, 0u);
}

TEST(TightCocone, DentedCube_HasADent) {
    // The point a tenth below the middle of the top takes a pyramid of volume 0.1 / 3 away. Its four triangles have
    // the height sqrt(0.5² + 0.1²).
    const TightCoconeResult result = closed_through(joined(lattice_cube(1), cloud_of({Vec3(0.5, 0.5, 0.9)})));
    expect_promised(result, 9);
    EXPECT_EQ(result.mesh.triangles.size(), 14u);
    EXPECT_NEAR(volume(result.mesh), 1 - 0.1 / 3, 1e-12);
    EXPECT_NEAR(result.area, 5 + 2 * std::sqrt(0.26), 1e-12);
}

TEST(TightCocone, OneTetrahedron_IsItself) {
    const TightCoconeResult result = closed_through(cloud_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
    expect_promised(result, 4);
    EXPECT_EQ(result.mesh.triangles.size(), 4u);
    EXPECT_NEAR(volume(result.mesh), 1.0 / 6, 1e-12);
    EXPECT_NEAR(result.area, 1.5 + std::sqrt(3.0) / 2, 1e-12);
}

TEST(TightCocone, LatticeOfACubesSurface_IsTheCube) {
    const TightCoconeResult result = closed_through(lattice_cube(8, 1, true));
    expect_promised(result, 386);
    EXPECT_EQ(result.mesh.triangles.size(), 768u);  // two for each of 6 × 8 × 8 squares
    EXPECT_NEAR(volume(result.mesh), 512, 1e-9);
    EXPECT_NEAR(result.area, 384, 1e-9);
    EXPECT_EQ(result.invented_area, 0);
}

TEST(TightCocone, SumOfTheCells_IsTheVolumeOfTheMesh) {
    const TightCoconeResult result = closed_through(poisson_torus(0.1));
    EXPECT_NEAR(volume(result.mesh), inside_volume(result.tets), 1e-9);
}

}  // namespace
}  // namespace scanmill
