// SPDX-License-Identifier: GPL-3.0-or-later
/// The numbers of one mesh: size, topology, shape, self-intersections.
#include <gmock/gmock.h>

#include <numbers>

#include "filters/measure_cases.hpp"

namespace scanmill::test {
namespace {

using std::numbers::pi;

std::size_t intersections(const TriangleMesh& mesh, unsigned threads = 2) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return count_self_intersections(mesh, TriangleTree(mesh.positions.span(), mesh.triangles.span(), 1), context);
}

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

TEST(SelfIntersections, GoodMeshes_HaveNone) {
    for (const TriangleMesh& mesh : {cube(), l_block(), icosahedron(), geodesic_sphere(1, 8), torus(2, 0.5, 30, 20),
                                     block_with_tunnels(2), rectangle(1, 1)})
        EXPECT_EQ(intersections(mesh), 0u);
}

TEST(SelfIntersections, Soup_HasThePairsOfTheMeshThatItDraws) {
    const TriangleMesh mesh = geodesic_sphere(1, 4);
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (const Triangle& triangle : mesh.triangles) {
        const u32 first = static_cast<u32>(positions.size());
        for (u32 vertex : triangle) positions.push_back(mesh.positions[vertex]);
        triangles.push_back({first, first + 1, first + 2});
    }
    EXPECT_EQ(intersections(soup(positions, triangles)), 0u);
}

TEST(SelfIntersections, Crossing_IsOnePair) {
    // A triangle through the middle of another.
    EXPECT_EQ(intersections(
                  soup({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {2, 1, 1}}, {{0, 1, 2}, {3, 4, 5}})),
              1u);
}

TEST(SelfIntersections, Touching_Counts) {
    const Array<Vec3> base{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    const auto with = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
        Array<Vec3> positions = base;
        for (const Vec3& p : {a, b, c}) positions.push_back(p);
        return intersections(soup(positions, {{0, 1, 2}, {3, 4, 5}}));
    };
    EXPECT_EQ(with({1, 1, 0}, {1, 1, 1}, {2, 1, 1}), 1u);  // a corner on the face
    EXPECT_EQ(with({1, 0, 0}, {1, -1, 0}, {2, -1, 0}), 1u);  // a corner on an edge
    EXPECT_EQ(with({0, 0, 0}, {-1, 0, 0}, {0, -1, 0}), 0u);  // a corner on a corner: a common vertex
    EXPECT_EQ(with({1, 0, 0}, {3, 0, 0}, {2, -1, 0}), 1u);  // a part of an edge
    EXPECT_EQ(with({0, 0, 0}, {4, 0, 0}, {2, -1, 0}), 0u);  // the whole edge: a common one
    EXPECT_EQ(with({1, 1, 1e-300}, {1, 1, 1}, {2, 1, 1}), 0u);  // next to the face
    EXPECT_EQ(with({0.5, 0.5, 0}, {1, 0.5, 0}, {0.5, 1, 0}), 1u);  // inside the face, in its plane
}

TEST(SelfIntersections, CommonVertices_DoNotCountButOtherCommonPointsDo) {
    // At one common corner: beside each other, crossing the opposite edge, flat on each other.
    const auto from_corner = [](const Vec3& b, const Vec3& c) {
        return intersections(soup({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, b, c}, {{0, 1, 2}, {0, 3, 4}}));
    };
    EXPECT_EQ(from_corner({-1, 0, 0}, {0, -1, 0}), 0u);
    EXPECT_EQ(from_corner({1, 1, 1}, {1, 1, -1}), 1u);
    EXPECT_EQ(from_corner({5, 5, 1}, {5, 5, -1}), 1u);
    EXPECT_EQ(from_corner({1, 2, 0}, {2, 1, 0}), 1u);
    // At one common edge: in a plane, folded at an angle, folded flat, and the same triangle again.
    const auto over_edge = [](const Vec3& d) {
        return intersections(soup({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, d}, {{0, 1, 2}, {1, 0, 3}}));
    };
    EXPECT_EQ(over_edge({0, -4, 0}), 0u);
    EXPECT_EQ(over_edge({0, 4, 1e-300}), 0u);
    EXPECT_EQ(over_edge({1, 1, 0}), 1u);
    EXPECT_EQ(intersections(soup({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}, {2, 1, 0}})), 1u);
}

TEST(SelfIntersections, CollinearTriangles_AreSkipped) {
    EXPECT_EQ(intersections(soup({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 0}, {1, 1, 1}},
                                 {{0, 1, 2}, {3, 4, 5}, {0, 0, 1}})),
              0u);
}

TEST(SelfIntersections, OverlappingCubes_CountTheSameForAnyThreads) {
    const TriangleMesh cubes = both(geodesic_sphere(1, 15), shifted(geodesic_sphere(1, 15), {0.5, 0.2, 0.1}));
    const std::size_t pairs = intersections(cubes, 1);
    EXPECT_GT(pairs, 100u);
    EXPECT_EQ(intersections(cubes, 3), pairs);
}

}  // namespace
}  // namespace scanmill::test
