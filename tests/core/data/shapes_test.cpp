// SPDX-License-Identifier: GPL-3.0-or-later
/// The fixtures' own properties, computed here without geometry/topology.hpp: that one is tested *with* them.
#include "support/shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace scanmill::test {
namespace {

/// Every directed edge occurs once, and its reverse too: closed and consistently oriented.
void expect_closed_and_oriented(const TriangleMesh& mesh) {
    std::set<std::pair<u32, u32>> directed;
    for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k)
            EXPECT_TRUE(directed.emplace(t[k], t[(k + 1) % 3]).second) << t[k] << " " << t[(k + 1) % 3];
    for (const auto& [a, b] : directed) EXPECT_TRUE(directed.contains({b, a})) << a << " " << b;
}

long euler(const TriangleMesh& mesh) {
    return static_cast<long>(mesh.positions.size()) - static_cast<long>(mesh.triangles.size()) / 2;  // E = 3F/2
}

void expect_distinct_vertices(const TriangleMesh& mesh) {
    std::set<std::array<double, 3>> seen;
    for (const Vec3& p : mesh.positions) EXPECT_TRUE(seen.insert({p.x(), p.y(), p.z()}).second) << p.transpose();
}

struct Facts {
    std::size_t vertices, triangles;
    long euler;
};
void expect_facts(const TriangleMesh& mesh, const Facts& facts) {
    ASSERT_NO_THROW(require_consistent(mesh));
    EXPECT_EQ(mesh.positions.size(), facts.vertices);
    EXPECT_EQ(mesh.triangles.size(), facts.triangles);
    EXPECT_EQ(euler(mesh), facts.euler);
    expect_closed_and_oriented(mesh);
    expect_distinct_vertices(mesh);
    EXPECT_GT(signed_volume(mesh), 0) << "triangles must face outwards";
}

TEST(Shapes, Cube_OfEdgeTwo_HasSixTimesFourAreaAndVolumeEight) {
    const TriangleMesh mesh = cube(2);
    expect_facts(mesh, {8, 12, 2});
    EXPECT_DOUBLE_EQ(area(mesh), 24);
    EXPECT_DOUBLE_EQ(signed_volume(mesh), 8);
    const BoundingBox box = bounding_box(mesh.positions.span());
    EXPECT_EQ(box.low, Vec3(0, 0, 0));
    EXPECT_EQ(box.high, Vec3(2, 2, 2));
}

TEST(Shapes, RegularTetrahedron_OfEdgeThree_HasSixEqualEdges) {
    const TriangleMesh mesh = regular_tetrahedron(3);
    expect_facts(mesh, {4, 4, 2});
    for (u32 a = 0; a < 4; ++a)
        for (u32 b = a + 1; b < 4; ++b) EXPECT_NEAR((mesh.positions[a] - mesh.positions[b]).norm(), 3, 1e-14);
    EXPECT_NEAR(area(mesh), std::numbers::sqrt3 * 9, 1e-13);
    EXPECT_NEAR(signed_volume(mesh), 27 / (6 * std::numbers::sqrt2), 1e-13);
}

TEST(Shapes, Icosahedron_OfRadiusTwo_HasEqualEdgesOnTheSphere) {
    const TriangleMesh mesh = icosahedron(2);
    expect_facts(mesh, {12, 20, 2});
    const double edge = 2 / std::sin(2 * std::numbers::pi / 5);
    for (const Vec3& p : mesh.positions) EXPECT_NEAR(p.norm(), 2, 1e-15 * 4);
    for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR((mesh.positions[t[k]] - mesh.positions[t[(k + 1) % 3]]).norm(), edge, 1e-14);
    EXPECT_NEAR(signed_volume(mesh), 5 * (3 + std::sqrt(5)) / 12 * std::pow(edge, 3), 1e-12);
}

TEST(Shapes, GeodesicSphere_OfFrequencySeven_LiesOnTheSphereAndFillsIt) {
    const u32 n = 7;
    const TriangleMesh mesh = geodesic_sphere(3, n);
    expect_facts(mesh, {10 * n * n + 2, 20 * n * n, 2});
    for (const Vec3& p : mesh.positions) EXPECT_NEAR(p.norm(), 3, 3e-15);
    EXPECT_LT(area(mesh), 36 * std::numbers::pi);
    EXPECT_GT(area(mesh), 0.985 * 36 * std::numbers::pi);
    EXPECT_LT(signed_volume(mesh), 36 * std::numbers::pi);
    EXPECT_GT(signed_volume(mesh), 0.975 * 36 * std::numbers::pi);
}

TEST(Shapes, GeodesicSphere_OfFrequencyOne_IsTheIcosahedron) {
    EXPECT_NEAR(signed_volume(geodesic_sphere(2, 1)), signed_volume(icosahedron(2)), 1e-13);
    expect_facts(geodesic_sphere(2, 1), {12, 20, 2});
}

TEST(Shapes, Torus_OfFiveAndTwo_HasGenusOneAndPappusVolume) {
    const TriangleMesh mesh = torus(5, 2, 60, 40);
    expect_facts(mesh, {2400, 4800, 0});
    for (const Vec3& p : mesh.positions) EXPECT_NEAR(std::hypot(std::hypot(p.x(), p.y()) - 5, p.z()), 2, 1e-14);
    const double pi = std::numbers::pi;
    EXPECT_NEAR(area(mesh), 4 * pi * pi * 5 * 2, 0.01 * 4 * pi * pi * 5 * 2);
    EXPECT_NEAR(signed_volume(mesh), 2 * pi * pi * 5 * 4, 0.01 * 2 * pi * pi * 5 * 4);
}

TEST(Shapes, LBlock_OfSizeTwo_HasAreaFiftySixAndVolumeTwentyFour) {
    const TriangleMesh mesh = l_block(2);
    expect_facts(mesh, {12, 20, 2});
    EXPECT_DOUBLE_EQ(area(mesh), 14 * 4);
    EXPECT_DOUBLE_EQ(signed_volume(mesh), 3 * 8);
}

TEST(Shapes, RandomSphere_ManyPoints_LieOnItAndHalfAreAbove) {
    const PointCloud cloud = random_sphere(10000, 1, 2);
    int above = 0;
    for (const Vec3& p : cloud.positions) {
        ASSERT_NEAR(p.norm(), 2, 1e-15 * 4);
        above += p.z() > 0;
    }
    EXPECT_NEAR(above, 5000, 5 * 50);  // five standard deviations of a fair coin
}

TEST(Shapes, WithoutTriangles_OfACube_LeavesTheOthersInOrder) {
    const TriangleMesh mesh = without_triangles(cube(), {0, 11});
    ASSERT_EQ(mesh.triangles.size(), 10u);
    EXPECT_EQ(mesh.triangles[0], cube().triangles[1]);
    EXPECT_EQ(mesh.triangles[9], cube().triangles[10]);
    EXPECT_EQ(mesh.positions.size(), 8u);
}

}  // namespace
}  // namespace scanmill::test
