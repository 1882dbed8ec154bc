// SPDX-License-Identifier: GPL-3.0-or-later
/// The pairs of a mesh's triangles that intersect.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "scanmill/geometry/distance/self_intersections.hpp"
#include "scanmill/geometry/distance/triangles_intersect.hpp"
#include "support/mesh_operations.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAreArray;

SelfIntersections all_intersections(const TriangleMesh& mesh, unsigned threads = 2,
                                    u64 most_pairs = std::numeric_limits<u64>::max()) {
    Execution execution({threads, {}, {}});
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    return self_intersections(mesh.positions.span(), mesh.triangles.span(), tree, execution, most_pairs);
}

u64 intersections(const TriangleMesh& mesh) { return all_intersections(mesh).count; }

TEST(SelfIntersections, GoodMeshes_HaveNone) {
    for (const TriangleMesh& mesh :
         {cube(), l_block(), icosahedron(), geodesic_sphere(1, 8), torus(2, 0.5, 30, 20), rectangle(1, 1)})
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

/// Two spheres that intersect.
TriangleMesh crossing_spheres() {
    return both(geodesic_sphere(1, 12), shifted(geodesic_sphere(1, 9), {0.5, 0.2, 0.1}));
}

TEST(SelfIntersections, Pairs_AreThoseOfTestingAllInAscendingOrder) {
    const TriangleMesh mesh = crossing_spheres();
    std::vector<std::array<u32, 2>> expected;
    for (u32 row = 0; row < mesh.triangles.size(); ++row)
        for (u32 other = row + 1; other < mesh.triangles.size(); ++other)
            if (triangles_intersect(mesh.positions.span(), mesh.triangles[row], mesh.triangles[other]))
                expected.push_back({row, other});
    EXPECT_GT(expected.size(), 100u);
    const SelfIntersections found = all_intersections(mesh);
    EXPECT_THAT(found.pairs, ElementsAreArray(expected));
    EXPECT_EQ(found.count, expected.size());
}

TEST(SelfIntersections, AnyNumberOfThreads_GivesTheSamePairs) {
    const TriangleMesh mesh = crossing_spheres();
    EXPECT_EQ(all_intersections(mesh, 1).pairs, all_intersections(mesh, 3).pairs);
}

TEST(SelfIntersections, FewerPairsWanted_AreTheFirstAndAllAreCounted) {
    const TriangleMesh mesh = crossing_spheres();
    const SelfIntersections all = all_intersections(mesh);
    for (const u64 wanted : {u64(0), u64(1), u64(50), u64(100'000)}) {
        const SelfIntersections first = all_intersections(mesh, 2, wanted);
        EXPECT_EQ(first.count, all.count);
        ASSERT_EQ(first.pairs.size(), std::min<u64>(wanted, all.count));
        EXPECT_TRUE(std::ranges::equal(first.pairs, std::span(all.pairs).first(first.pairs.size())));
    }
}

TEST(SelfIntersections, Cancelled_Ends) {
    const TriangleMesh mesh = crossing_spheres();
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    Execution execution({1, {}, [] { return true; }});
    EXPECT_THROW(self_intersections(mesh.positions.span(), mesh.triangles.span(), tree, execution), Cancelled);
}

}  // namespace
}  // namespace scanmill::test
