// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/triangle_tree.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "scanmill/base/random.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/geometry/spatial/triangle_distance.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;

/// Triangles of all sizes, some of them segments or points, many with common corners.
TriangleMesh random_soup(std::size_t triangles, std::uint64_t seed, double size, const Vec3& at = Vec3::Zero()) {
    Random random(seed);
    Array<Vec3> positions;
    Array<Triangle> rows;
    for (std::size_t i = 0; i < triangles; ++i) {
        const Vec3 middle(random.uniform(), random.uniform(), random.uniform());
        const double reach = size * random.uniform();
        for (int corner = 0; corner < 3; ++corner)
            positions.push_back(at + middle + reach * Vec3(random.normal(), random.normal(), random.normal()));
        const u32 first = static_cast<u32>(3 * i), any = static_cast<u32>(random.index(positions.size()));
        rows.push_back(i % 7 == 0    ? Triangle{first, first, first + 1}
                       : i % 11 == 0 ? Triangle{first, first, first}
                       : i % 3 == 0  ? Triangle{first, any, first + 1}
                                     : Triangle{first, first + 1, first + 2});
    }
    TriangleMesh mesh;
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(rows);
    return mesh;
}

NearestTriangle nearest_of_all(const TriangleMesh& mesh, const Vec3& point) {
    NearestTriangle best;
    for (u32 row = 0; row < mesh.triangles.size(); ++row) {
        const auto& [a, b, c] = mesh.triangles[row];
        const double squared =
            (nearest_on_triangle(point, mesh.positions[a], mesh.positions[b], mesh.positions[c]) - point).squaredNorm();
        if (squared < best.squared_distance) best = {row, 0, squared};
    }
    return best;
}

void expect_same_as_all(const TriangleMesh& mesh, const TriangleTree& tree, const Vec3& point, u32 hint) {
    const NearestTriangle expected = nearest_of_all(mesh, point), found = tree.nearest(point, hint);
    EXPECT_EQ(found.triangle, expected.triangle) << point.transpose();
    EXPECT_EQ(found.squared_distance, expected.squared_distance) << point.transpose();
    EXPECT_EQ(tree.squared_distance(point, found.slot), found.squared_distance);
}

TEST(TriangleTree, RandomSoups_AnswerAsLookingAtAllTriangles) {
    for (std::size_t triangles : {1, 2, 3, 4, 5, 15, 16, 17, 63, 64, 65, 257, 1000, 4097})
        for (double size : {0.0, 0.02, 0.5}) {
            const TriangleMesh mesh = random_soup(triangles, triangles, size);
            const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
            EXPECT_EQ(tree.size(), triangles);
            Random random(triangles + 1);
            for (int i = 0; i < 60; ++i) {
                const double reach = i % 3 == 0 ? 1 : i % 3 == 1 ? 10 : 1e9;
                const Vec3 point(random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform());
                const u32 hint = i % 2 ? static_cast<u32>(random.index(triangles)) : NearestTriangle::none;
                expect_same_as_all(mesh, tree, point, hint);
            }
        }
}

TEST(TriangleTree, PointsOnTheSurface_AnswerAsLookingAtAllTriangles) {
    // Where a corner, an edge or rounding makes several triangles about equally near; also far from the origin.
    for (const Vec3& at : {Vec3(0, 0, 0), Vec3(1e6, -2e6, 3e6)}) {
        const TriangleMesh mesh = random_soup(800, 5, 0.1, at);
        const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
        for (u32 row = 0; row < 800; ++row) {
            const auto& [a, b, c] = mesh.triangles[row];
            expect_same_as_all(mesh, tree, mesh.positions[a], NearestTriangle::none);
            expect_same_as_all(mesh, tree, (mesh.positions[a] + mesh.positions[b]) / 2, row);
            expect_same_as_all(mesh, tree, (mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) / 3, 799 - row);
        }
    }
}

TEST(TriangleTree, EquallyNearTriangles_GiveTheSmallestRow) {
    // The centre of a cube is 0.5 from all twelve triangles; a corner belongs to several.
    const TriangleMesh mesh = cube();
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    for (u32 hint = 0; hint < 12; ++hint) {
        EXPECT_EQ(tree.nearest({0.5, 0.5, 0.5}, hint).triangle, 0u);
        EXPECT_EQ(tree.nearest({0.5, 0.5, 0.5}, hint).squared_distance, 0.25);
    }
    // The same triangle a thousand times.
    Array<Triangle> rows(1000, Triangle{0, 1, 2});
    const TriangleTree equal(mesh.positions.span(), rows, 1);
    for (u32 hint : {0u, 500u, 999u}) EXPECT_EQ(equal.nearest({3, 4, 5}, hint).triangle, 0u);
}

/// Asks with distances equal to that of the nearest triangle, a little smaller and a little larger, and far from it.
void expect_within_as_all(const TriangleMesh& mesh, const TriangleTree& tree, const Vec3& point, u32 hint) {
    const double nearest = nearest_of_all(mesh, point).squared_distance;
    for (const double squared : {nearest, std::nextafter(nearest, 0.0), std::nextafter(nearest, 1e300), nearest / 2,
                                 2 * nearest, 0.0, 1e300}) {
        u32 slot = hint;
        ASSERT_EQ(tree.is_within(point, squared, slot), nearest <= squared) << point.transpose() << ": " << squared;
        if (nearest <= squared)
            EXPECT_LE(tree.squared_distance(point, slot), squared) << "the hint is the triangle that was found";
        else
            EXPECT_EQ(slot, hint);
    }
}

TEST(TriangleTree, IsWithin_AnswersAsLookingAtAllTriangles) {
    for (std::size_t triangles : {1, 2, 5, 16, 65, 1000})
        for (double size : {0.0, 0.02, 0.5})
            for (const Vec3& at : {Vec3(0, 0, 0), Vec3(1e6, -2e6, 3e6)}) {
                const TriangleMesh mesh = random_soup(triangles, triangles, size, at);
                const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
                Random random(triangles + 1);
                for (int i = 0; i < 40; ++i) {
                    const double reach = i % 3 == 0 ? 1 : i % 3 == 1 ? 10 : 1e9;
                    const Vec3 point(random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform());
                    const u32 hint = i % 2 ? static_cast<u32>(random.index(triangles)) : NearestTriangle::none;
                    expect_within_as_all(mesh, tree, at + point, hint);
                    expect_within_as_all(mesh, tree, mesh.positions[random.index(mesh.positions.size())], hint);
                }
            }
}

TEST(TriangleTree, IsWithin_CountsTheBorder) {
    const TriangleMesh mesh = cube();
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    u32 hint = NearestTriangle::none;
    EXPECT_FALSE(tree.is_within({0.5, 0.5, 3}, std::nextafter(4.0, 0.0), hint));
    EXPECT_EQ(hint, NearestTriangle::none);
    EXPECT_TRUE(tree.is_within({0.5, 0.5, 3}, 4, hint));
    EXPECT_EQ(tree.squared_distance({0.5, 0.5, 3}, hint), 4);
    EXPECT_TRUE(tree.is_within({1, 0.5, 0.5}, 0, hint)) << "on the surface";
    EXPECT_FALSE(tree.is_within({1.5, 0.5, 0.5}, 0, hint));
}

TEST(TriangleTree, VeryFarPoints_AreAnswered) {
    const TriangleMesh mesh = geodesic_sphere(1, 6);
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    for (double far : {1e8, 1e20, 1e45, 1e70})
        EXPECT_NEAR(std::sqrt(tree.nearest({far, -far, 0}).squared_distance) / far, std::sqrt(2), 1e-7);
}

TEST(TriangleTree, VerySmallMesh_AnswersAsLookingAtAllTriangles) {
    TriangleMesh mesh = random_soup(300, 9, 0.1);
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    for (Vec3& p : positions) p *= 1e-30;
    mesh.positions = std::move(positions);
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    Random random(2);
    for (int i = 0; i < 50; ++i)
        expect_same_as_all(mesh, tree, 1e-30 * Vec3(random.uniform(), random.uniform(), random.uniform()),
                           NearestTriangle::none);
}

TEST(TriangleTree, AnyNumberOfThreads_MakesTheSameTree) {
    const TriangleMesh mesh = random_soup(50'000, 3, 0.01);
    const TriangleTree one(mesh.positions.span(), mesh.triangles.span(), 1);
    const TriangleTree three(mesh.positions.span(), mesh.triangles.span(), 3);
    Random random(4);
    for (int i = 0; i < 500; ++i) {
        const Vec3 point(random.uniform(), random.uniform(), random.uniform());
        EXPECT_EQ(one.nearest(point).slot, three.nearest(point).slot);
    }
}

TEST(TriangleTree, Meeting_FindsEveryTriangleWhoseBoxMeets) {
    const TriangleMesh mesh = random_soup(3000, 8, 0.1);
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    Random random(6);
    for (int i = 0; i < 100; ++i) {
        const Vec3 low(random.uniform(), random.uniform(), random.uniform());
        const BoundingBox box{low, low + Vec3::Constant(0.3 * random.uniform())};
        std::vector<u32> expected;
        for (u32 row = 0; row < mesh.triangles.size(); ++row) {
            Vec3 least = mesh.positions[mesh.triangles[row][0]], most = least;
            for (u32 vertex : mesh.triangles[row]) {
                least = least.cwiseMin(mesh.positions[vertex]);
                most = most.cwiseMax(mesh.positions[vertex]);
            }
            if ((least.array() <= box.high.array()).all() && (most.array() >= box.low.array()).all())
                expected.push_back(row);
        }
        Array<u32> found;
        tree.meeting(box, found);
        EXPECT_THAT(std::vector<u32>(found.begin(), found.end()), testing::UnorderedElementsAreArray(expected));
    }
}

TEST(TriangleTree, Meeting_CountsBorders) {
    const TriangleMesh mesh = cube();
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    Array<u32> found;
    tree.meeting({{1, 1, 1}, {2, 2, 2}}, found);  // all triangles of the three faces there reach their edges
    EXPECT_GE(found.size(), 3u);
    found.clear();
    tree.meeting({{1 + 1e-15, 0, 0}, {2, 2, 2}}, found);
    EXPECT_TRUE(found.empty());
}

TEST(TreeOfPoints, FindsTheNearestPoint) {
    const PointCloud cloud = random_cube(2000, 1);
    const TriangleTree tree = tree_of_points(cloud.positions.span(), 2);
    const PointCloud queries = random_cube(200, 2, 1.5);
    for (const Vec3& query : queries.positions) {
        const auto nearest =
            std::ranges::min_element(cloud.positions, {}, [&](const Vec3& p) { return (p - query).squaredNorm(); });
        const NearestTriangle found = tree.nearest(query);
        EXPECT_EQ(found.triangle, nearest - cloud.positions.begin());
        EXPECT_EQ(found.squared_distance, (*nearest - query).squaredNorm());
    }
}

TEST(TriangleTree, RealScan_AnswersAsLookingAtAllTriangles) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/elephant.off");
    const auto mesh = read_mesh(path);
    const TriangleTree tree(mesh->positions.span(), mesh->triangles.span(), 2);
    Random random(1);
    const BoundingBox box = bounding_box(mesh->positions.span());
    u32 hint = NearestTriangle::none;
    for (int i = 0; i < 200; ++i) {
        Vec3 point = mesh->positions[random.index(mesh->positions.size())];
        point += 0.01 * i / 200 * box.diagonal() * Vec3(random.normal(), random.normal(), random.normal());
        expect_same_as_all(*mesh, tree, point, hint);
        hint = tree.nearest(point).slot;
    }
}

}  // namespace
}  // namespace scanmill
