// SPDX-License-Identifier: GPL-3.0-or-later
/// Points near other points or a mesh: by hand, borders, and against a search over everything.

#include <gmock/gmock.h>

#include <cmath>

#include "filters/crop/cases.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/geometry/spatial/triangle_distance.hpp"
#include "support/real_data.hpp"
#include "support/same_points.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;

TEST(CropNear, Points_KeepsPointsWithinTheDistanceBordersIncluded) {
    const PointCloud near = cloud_of({{0, 0, 0}, {10, 0, 0}});
    const PointCloud cloud = cloud_of({{3, 4, 0}, {10, 5, 0}, {10, 0, 5.001}, {5, 0, 0}, {5, 1, 0}, {0, 0, 0}});
    const Cropped result = cropped(cloud, in_reach(5), 1, near);
    EXPECT_THAT(rows(result), ElementsAre(0u, 1u, 3u, 5u));
    EXPECT_EQ(result.removed, 2u);
    EXPECT_EQ(result.metrics.find("kept")->value, 4);
    EXPECT_EQ(result.metrics.find("removed")->value, 2);
    EXPECT_THAT(rows(cropped(cloud, in_reach(0), 1, near)), ElementsAre(5u));
}

TEST(CropNear, Mesh_MeasuresToTheTrianglesNotToTheVertices) {
    // Around the unit cube: over a face's middle, beside an edge, beside a corner, inside.
    const PointCloud cloud =
        cloud_of({{0.3, 0.4, 3}, {0.3, 0.4, 3.001}, {0.5, -1.2, -1.6}, {2, 3, 3}, {-1, -2, -2}, {0.5, 0.5, 0.5}});
    EXPECT_THAT(rows(cropped(cloud, in_reach(2), 1, cube())), ElementsAre(0u, 2u, 5u));
    EXPECT_THAT(rows(cropped(cloud, in_reach(3), 1, cube())), ElementsAre(0u, 1u, 2u, 3u, 4u, 5u));
    EXPECT_THAT(rows(cropped(cloud, in_reach(0.5), 1, cube())), ElementsAre(5u));
    EXPECT_THAT(rows(cropped(cloud, in_reach(2), 1, vertices_of(cube()))), ElementsAre(5u)) << "of the vertices alone";
}

TEST(CropNear, Points_AgreesWithASearchOverAll) {
    const PointCloud cloud = random_cube(3000, 1), near = random_sphere(400, 2, 0.8);
    for (const double within : {0.02, 0.1, 0.4}) {
        std::vector<u32> expected;
        for (u32 row = 0; row < cloud.size(); ++row)
            if (std::ranges::any_of(near.positions, [&](const Vec3& p) {
                    return (p - cloud.positions[row]).squaredNorm() <= within * within;
                }))
                expected.push_back(row);
        EXPECT_FALSE(expected.empty());
        EXPECT_EQ(rows(cropped(cloud, in_reach(within), 2, near)), expected);
    }
}

TEST(CropNear, Mesh_AgreesWithASearchOverAll) {
    const PointCloud cloud = random_cube(3000, 3);
    const TriangleMesh near = torus(0.7, 0.2, 20, 10);
    for (const double within : {0.01, 0.1, 0.3}) {
        std::vector<u32> expected;
        for (u32 row = 0; row < cloud.size(); ++row)
            if (std::ranges::any_of(near.triangles, [&](const Triangle& t) {
                    const Vec3& p = cloud.positions[row];
                    return (nearest_on_triangle(p, near.positions[t[0]], near.positions[t[1]], near.positions[t[2]]) -
                            p)
                               .squaredNorm() <= within * within;
                }))
                expected.push_back(row);
        EXPECT_FALSE(expected.empty());
        EXPECT_EQ(rows(cropped(cloud, in_reach(within), 1, near)), expected);
    }
}

TEST(CropNear, OfAnotherOrigin_IsMovedByTheDifference) {
    PointCloud cloud = cloud_of({{0, 0, 0}, {3, 0, 0}, {6, 0, 0}});
    cloud.frame.origin = {1e6, 0, 0};
    PointCloud near = cloud_of({{106, 0, 0}});
    near.frame.origin = {1e6 - 100, 0, 0};
    EXPECT_THAT(rows(cropped(cloud, in_reach(3), 1, near)), ElementsAre(1u, 2u));
    TriangleMesh mesh = cube();
    mesh.frame.origin = {1e6 + 4, 0, 0};
    EXPECT_THAT(rows(cropped(cloud, in_reach(1), 1, mesh)), ElementsAre(1u, 2u));
}

TEST(CropNear, ItsOwnPoints_AreAllKept) {
    const PointCloud cloud = random_cube(5000, 4);
    EXPECT_TRUE(same_points(cropped(cloud, in_reach(0), 2, cloud).points, cloud));
}

TEST(CropNear, AnyNumberOfThreads_GivesTheSame) {
    const PointCloud cloud = random_cube(100'000, 5);
    const TriangleMesh near = geodesic_sphere(0.9, 12);
    const Cropped one = cropped(cloud, in_reach(0.05), 1, near), three = cropped(cloud, in_reach(0.05), 3, near);
    EXPECT_TRUE(same_points(one.points, three.points));
    EXPECT_EQ(one.metrics.values, three.metrics.values);
    EXPECT_GT(one.kept.size(), 1000u);
    EXPECT_GT(one.removed, 1000u);
}

TEST(CropNear, Cancelled_Ends) {
    ContextOptions options;
    options.is_cancelled = [] { return true; };
    Context context(options);
    EXPECT_THROW(crop(random_cube(1000, 1), cube(), in_reach(1), context), Cancelled);
}

TEST(CropNear, RealScan_NearItsOwnModelIsKeptAndShiftedMostlyRemoved) {
    SCANMILL_REAL_SCAN(path, shared_data, "1-bunny/bun_zipper.ply");
    const auto model = read_mesh(path);
    const PointCloud cloud = points_of(without_unused_vertices(*model));
    EXPECT_TRUE(same_points(cropped(cloud, in_reach(0), 2, *model).points, cloud)) << "vertices are on the surface";
    const std::size_t unused = model->positions.size() - cloud.size();
    EXPECT_EQ(unused, 1113u);
    EXPECT_EQ(cropped(points_of(*model), in_reach(0), 2, *model).removed, unused) << "these are in no triangle";
    PointCloud shifted = cloud;
    shifted.positions = translated(cloud.positions, {0, 0.05, 0});  // a third of the model's height, in metres
    const Cropped result = cropped(shifted, in_reach(1e-3), 2, *model);
    EXPECT_GT(result.kept.size(), 100u);
    EXPECT_GT(result.removed, 30'000u);
}

}  // namespace
}  // namespace scanmill::test
