// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/spacing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "scanmill/formats/files.hpp"
#include "support/numbers.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

/// Distance from every point to the nearest other one, sorted.
std::vector<double> nearest_distances(std::span<const Vec3> points) {
    std::vector<double> distances;
    for (std::size_t i = 0; i < points.size(); ++i) {
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t j = 0; j < points.size(); ++j)
            if (i != j) nearest = std::min(nearest, (points[i] - points[j]).norm());
        distances.push_back(nearest);
    }
    std::ranges::sort(distances);
    return distances;
}

double spacing(std::vector<Vec3> points) { return point_spacing(points); }

TEST(PointSpacing, RandomClouds_HaveTheBruteForceMedian) {
    for (const u32 count : {3u, 10u, 101u, 1000u}) {
        const PointCloud cloud = random_cube(count, count, 7);
        EXPECT_DOUBLE_EQ(point_spacing(cloud.positions.span()), nearest_distances(cloud.positions.span())[count / 2])
            << count;
        const PointCloud sphere = random_sphere(count, count, 0.01);
        EXPECT_DOUBLE_EQ(point_spacing(sphere.positions.span()), nearest_distances(sphere.positions.span())[count / 2])
            << count;
    }
}

TEST(PointSpacing, HandComputedCloud) {
    // Nearest others at 1, 1, 2, 4: of an even number the upper of the middle two.
    EXPECT_EQ(spacing({{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {7, 0, 0}}), 2);
    EXPECT_EQ(spacing({{0, 0, 0}, {1, 0, 0}, {3, 0, 0}}), 1);
}

TEST(PointSpacing, TwoPoints_AreTheirDistance) { EXPECT_EQ(spacing({{0, 0, 0}, {0, 3, 4}}), 5); }

TEST(PointSpacing, FewerThanTwoPoints_AreNone) {
    EXPECT_EQ(spacing({}), 0);
    EXPECT_EQ(spacing({{1, 2, 3}}), 0);
    EXPECT_EQ(spacing({{1, 2, 3}, {nan, 0, 0}}), 0);
}

TEST(PointSpacing, OrderOfMorePointsThanAreAsked_DoesNotMatter) {
    const PointCloud cloud = random_cube(250'000, 3, 7);
    std::vector<Vec3> points(cloud.positions.begin(), cloud.positions.end());
    const double forwards = point_spacing(points);
    std::ranges::reverse(points);
    EXPECT_EQ(point_spacing(points), forwards);
    std::ranges::sort(points, {}, [](const Vec3& p) { return p.x(); });
    EXPECT_EQ(point_spacing(points), forwards);
    EXPECT_GT(forwards, 0);
}

TEST(PointSpacing, Zeros_AreEqualWhateverTheirSign) {
    EXPECT_EQ(spacing({{0.0, 0, 0}, {-0.0, 0, 0}, {0, -0.0, -0.0}, {5, 0, 0}}), 0);
}

TEST(PointSpacing, Duplicates_AreAtDistanceZero) {
    EXPECT_EQ(spacing({{1, 1, 1}, {1, 1, 1}}), 0);
    // Two of three coincide: distances 0, 0, 5.
    EXPECT_EQ(spacing({{0, 0, 0}, {0, 0, 0}, {5, 0, 0}}), 0);
    // Two of five coincide: distances 0, 0, 1, 1, 1.
    EXPECT_EQ(spacing({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}), 1);
    EXPECT_EQ(spacing(std::vector<Vec3>(1'000'000, Vec3(1, 2, 3))), 0) << "and this does not take a million squared";
}

TEST(PointSpacing, NonFinitePoints_ArePassedOver) {
    EXPECT_EQ(spacing({{nan, 0, 0}, {0, 0, 0}, {0, infinity, 0}, {0, 0, 2}, {0, 0, nan}}), 2);
}

TEST(PointSpacing, Grid_HasItsPitchInAnyOrder) {
    Array<Vec3> points;
    for (int i = 0; i < 20; ++i)
        for (int j = 0; j < 20; ++j) points.push_back({0.5 * i, 0.5 * j, 3});
    EXPECT_EQ(point_spacing(points), 0.5);
    std::ranges::reverse(points);
    EXPECT_EQ(point_spacing(points), 0.5);
}

TEST(PointSpacing, Scaling_ScalesIt) {
    const PointCloud cloud = random_cube(500, 4);
    Array<Vec3> scaled(cloud.positions.begin(), cloud.positions.end());
    for (Vec3& p : scaled) p *= 1024;
    EXPECT_EQ(point_spacing(scaled), 1024 * point_spacing(cloud.positions.span()));
}

TEST(PointSpacing, CloudTooLargeToAskEveryPoint_IsAskedAllOver) {
    // Pairs along a line: the first half at distance 1, the rest at 3. Every point sees its partner, asked or not.
    Array<Vec3> points;
    for (int pair = 0; pair < 110'000; ++pair) {
        points.push_back({10.0 * pair, 0, 0});
        points.push_back({10.0 * pair + (pair < 50'000 ? 1 : 3), 0, 0});
    }
    EXPECT_EQ(point_spacing(points), 3) << "six of eleven pairs";
    std::ranges::reverse(points);
    EXPECT_EQ(point_spacing(points), 3);
}

TEST(PointSpacing, RealScan_HasTheBruteForceMedian) {
    SCANMILL_REAL_SCAN(file, fetched_data, "meshes/ChineseDragon-10kv.off");
    const auto mesh = read_mesh(file);
    const std::size_t count = mesh->positions.size();
    ASSERT_GT(count, 9'000u);
    EXPECT_DOUBLE_EQ(point_spacing(mesh->positions.span()), nearest_distances(mesh->positions.span())[count / 2]);
    EXPECT_LE(point_spacing(mesh->positions.span()), edge_spacing(*mesh))
        << "an edge is at least as long as the distance to the nearest point";
}

TEST(EdgeSpacing, Cube_IsItsEdge) {
    // 12 triangles, each with two edges of the cube and one diagonal of a face.
    EXPECT_EQ(edge_spacing(cube(3)), 3);
    EXPECT_DOUBLE_EQ(edge_spacing(regular_tetrahedron(2)), 2);
}

TEST(EdgeSpacing, HandComputedTriangles) {
    TriangleMesh mesh;
    mesh.positions = {Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(0, 4, 0), Vec3(6, 8, 0)};
    mesh.triangles = {{0, 1, 2}};
    EXPECT_EQ(edge_spacing(mesh), 4) << "3, 4, 5";
    // The hypotenuse is counted with both triangles: 3, 4, 5, 5, sqrt(52), sqrt(73).
    mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
    EXPECT_EQ(edge_spacing(mesh), 5);
}

TEST(EdgeSpacing, NoTriangles_HaveNone) {
    EXPECT_EQ(edge_spacing(TriangleMesh{}), 0);
    EXPECT_EQ(edge_spacing(without_triangles(regular_tetrahedron(), {0, 1, 2, 3})), 0);
}

TEST(EdgeSpacing, EdgesOfNonFiniteVertices_ArePassedOver) {
    TriangleMesh mesh;
    mesh.positions = {Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(0, 4, 0), Vec3(nan, 0, 0)};
    mesh.triangles = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    EXPECT_EQ(edge_spacing(mesh), 4) << "3, 4 and 5 remain";
    mesh.positions = {Vec3(nan, 0, 0), Vec3(nan, 0, 0), Vec3(nan, 0, 0), Vec3(nan, 0, 0)};
    EXPECT_EQ(edge_spacing(mesh), 0);
}

}  // namespace
}  // namespace scanmill::test
