// SPDX-License-Identifier: GPL-3.0-or-later
/// The numbers of one mesh: size, topology, shape.
#include <gmock/gmock.h>

#include <numbers>

#include "filters/measure/cases.hpp"

namespace scanmill::test {
namespace {

using std::numbers::pi;

/// A block of height 1 with tunnels of 1 × 1 through it; genus = tunnels. Made of the outer faces of unit cubes.
TriangleMesh block_with_tunnels(u32 tunnels) {
    const u32 width = 2 * tunnels + 1;
    const auto is_solid = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < static_cast<int>(width) && y < 3 && !(y == 1 && x % 2 == 1);
    };
    Array<Vec3> positions;
    Array<Triangle> triangles;
    const auto vertex = [&](u32 x, u32 y, u32 z) { return (z * 4 + y) * (width + 1) + x; };
    for (u32 z = 0; z < 2; ++z)
        for (u32 y = 0; y < 4; ++y)
            for (u32 x = 0; x <= width; ++x) positions.push_back(Vec3(x, y, z));
    const auto quad = [&](u32 a, u32 b, u32 c, u32 d) {
        triangles.push_back({a, b, c});
        triangles.push_back({a, c, d});
    };
    for (u32 x = 0; x < width; ++x)
        for (u32 y = 0; y < 3; ++y) {
            const int i = static_cast<int>(x), j = static_cast<int>(y);
            if (!is_solid(i, j)) continue;
            quad(vertex(x, y, 1), vertex(x + 1, y, 1), vertex(x + 1, y + 1, 1), vertex(x, y + 1, 1));
            quad(vertex(x, y, 0), vertex(x, y + 1, 0), vertex(x + 1, y + 1, 0), vertex(x + 1, y, 0));
            if (!is_solid(i - 1, j)) quad(vertex(x, y, 0), vertex(x, y, 1), vertex(x, y + 1, 1), vertex(x, y + 1, 0));
            if (!is_solid(i + 1, j))
                quad(vertex(x + 1, y, 0), vertex(x + 1, y + 1, 0), vertex(x + 1, y + 1, 1), vertex(x + 1, y, 1));
            if (!is_solid(i, j - 1)) quad(vertex(x, y, 0), vertex(x + 1, y, 0), vertex(x + 1, y, 1), vertex(x, y, 1));
            if (!is_solid(i, j + 1))
                quad(vertex(x, y + 1, 0), vertex(x, y + 1, 1), vertex(x + 1, y + 1, 1), vertex(x + 1, y + 1, 0));
        }
    return soup(std::move(positions), std::move(triangles));
}

TEST(MeasureMesh, AreaAndVolume_AreClosedForms) {
    const MeshNumbers block = mesh_numbers(l_block(2), 1);
    EXPECT_DOUBLE_EQ(block.area, 14 * 4);
    EXPECT_DOUBLE_EQ(*block.volume, 3 * 8);
    EXPECT_DOUBLE_EQ(*mesh_numbers(inside_out(l_block(2)), 1).volume, -3 * 8);
    // Far from 0 the volume is not a difference of large numbers.
    EXPECT_NEAR(*mesh_numbers(shifted(cube(), {1 << 20, 1 << 20, 1 << 20}), 1).volume, 1, 1e-12);
    EXPECT_FALSE(mesh_numbers(without_triangles(cube(), {3}), 1).volume);
    EXPECT_DOUBLE_EQ(mesh_numbers(without_triangles(cube(), {3}), 1).area, 5.5);
}

TEST(MeasureMesh, Genus_CountsTunnels) {
    for (u32 tunnels : {0u, 1u, 2u, 5u}) {
        const MeshNumbers numbers = mesh_numbers(block_with_tunnels(tunnels), 1);
        EXPECT_TRUE(numbers.topology.closed);
        EXPECT_EQ(numbers.topology.genus, static_cast<long>(tunnels));
        EXPECT_DOUBLE_EQ(*numbers.volume, 3 * (2 * tunnels + 1) - tunnels);
    }
    EXPECT_EQ(mesh_numbers(torus(2, 1, 9, 7), 1).topology.genus, 1);
    EXPECT_EQ(mesh_numbers(rectangle(1, 1), 1).topology.genus, 0);
    EXPECT_EQ(mesh_numbers(rectangle(1, 1), 1).topology.boundary_loops, 1u);
    EXPECT_EQ(mesh_numbers(both(cube(), torus(2, 1, 9, 7)), 1).topology.components, 2u);
}

TEST(MeasureMesh, Shape_OfKnownTriangles) {
    const MeshNumbers equilateral = mesh_numbers(regular_tetrahedron(3), 1);
    EXPECT_NEAR(equilateral.least_angle, pi / 3, 1e-15);
    EXPECT_NEAR(equilateral.largest_aspect, 1, 1e-14);
    const MeshNumbers halves = mesh_numbers(cube(), 1);  // half squares: inradius 1 - 1/√2, longest edge √2
    EXPECT_NEAR(halves.least_angle, pi / 4, 1e-15);
    EXPECT_NEAR(halves.angle_p50, pi / 4, 1e-15);
    EXPECT_NEAR(halves.largest_aspect, std::sqrt(2) / (2 * std::sqrt(3) * (1 - std::sqrt(0.5))), 1e-14);
}

TEST(MeasureMesh, ShapeQuantiles_AreByNearestRank) {
    // 20 triangles with smallest angles of 1° … 20°: p5 is the first of them, p50 the tenth.
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 i = 1; i <= 20; ++i) {
        const double angle = i * pi / 180;
        for (const Vec3& p : {Vec3(0, 0, i), Vec3(1, 0, i), Vec3(std::cos(angle), std::sin(angle), i)})
            positions.push_back(p);
        triangles.push_back({3 * i - 3, 3 * i - 2, 3 * i - 1});
    }
    const MeshNumbers numbers = mesh_numbers(soup(positions, triangles), 1);
    EXPECT_NEAR(numbers.least_angle, pi / 180, 1e-14);
    EXPECT_NEAR(numbers.angle_p5, pi / 180, 1e-14);
    EXPECT_NEAR(numbers.angle_p50, 10 * pi / 180, 1e-14);
}

TEST(MeasureMesh, NearNeedles_HaveAFiniteAspect) {
    const MeshNumbers numbers = mesh_numbers(soup({{0, 0, 0}, {1, 0, 0}, {0.5, 1e-9, 0}}, {{0, 1, 2}}), 1);
    EXPECT_EQ(numbers.collinear_triangles, 0u);
    EXPECT_NEAR(numbers.least_angle, 2e-9, 1e-15);
    EXPECT_NEAR(numbers.largest_aspect * 1e-9, 2 / (2 * std::sqrt(3)), 1e-9);
}

TEST(MeasureMesh, SelfIntersections_AreCountedIfRequested) {
    const TriangleMesh block = block_with_tunnels(2);
    EXPECT_EQ(measured(block, block, few_samples()).self_intersections, 0u);
    const TriangleMesh crossing =
        soup({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {2, 1, 1}}, {{0, 1, 2}, {3, 4, 5}});
    MeasureParams params = few_samples();
    EXPECT_EQ(measured(crossing, crossing, params).self_intersections, 1u);
    params.self_intersections = false;
    EXPECT_EQ(measured(crossing, crossing, params).self_intersections, std::nullopt);
}

}  // namespace
}  // namespace scanmill::test
