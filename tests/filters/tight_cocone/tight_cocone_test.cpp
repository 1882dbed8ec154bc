// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes of known topology and volume, whole and with parts missing.

#include <Eigen/Geometry>

#include "filters/tight_cocone/cases.hpp"
#include "support/thrown.hpp"

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
    double hull = 0;
    for (const Tetrahedron& cell : result.tets.cells) {
        const auto& p = result.tets.positions;
        hull += (p[cell[1]] - p[cell[0]]).cross(p[cell[2]] - p[cell[0]]).dot(p[cell[3]] - p[cell[0]]) / 6;
    }
    EXPECT_NEAR(volume(result.mesh), hull, 1e-9);
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

TEST(TightCocone, SumOfTheCells_IsTheVolumeOfTheMesh) {
    const TightCoconeResult result = closed_through(poisson_torus(0.1));
    double cells = 0;
    for (std::size_t c = 0; c < result.tets.cells.size(); ++c) {
        const auto& p = result.tets.positions;
        const Tetrahedron& cell = result.tets.cells[c];
        if (result.tets.inside[c] == 1)
            cells += (p[cell[1]] - p[cell[0]]).cross(p[cell[2]] - p[cell[0]]).dot(p[cell[3]] - p[cell[0]]) / 6;
    }
    EXPECT_NEAR(volume(result.mesh), cells, 1e-9);
}

}  // namespace
}  // namespace scanmill
