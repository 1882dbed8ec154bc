// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/voxel_thin/cases.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using ::testing::ElementsAre;

using Voxel = std::array<double, 3>;
Voxel voxel_of(const Vec3& p, const Vec3& origin, double size) {
    return {std::floor((p.x() - origin.x()) / size), std::floor((p.y() - origin.y()) / size),
            std::floor((p.z() - origin.z()) / size)};
}
double distance_to_centre(const Vec3& p, const Vec3& origin, double size) {
    const Voxel voxel = voxel_of(p, origin, size);
    return (p - (origin + size * Vec3(voxel[0] + 0.5, voxel[1] + 0.5, voxel[2] + 0.5))).squaredNorm();
}

/// The definition, evaluated slowly.
std::vector<u32> nearest_by_definition(const PointCloud& cloud, const Vec3& origin, double size, u32 min_points = 1) {
    std::map<Voxel, std::vector<u32>> members;
    for (u32 i = 0; i < cloud.size(); ++i) members[voxel_of(cloud.positions[i], origin, size)].push_back(i);
    std::vector<u32> kept;
    for (const auto& [voxel, rows] : members)
        if (rows.size() >= min_points)
            kept.push_back(*std::ranges::min_element(rows, {}, [&](u32 row) {
                return std::pair(distance_to_centre(cloud.positions[row], origin, size), row);
            }));
    std::ranges::sort(kept);
    return kept;
}

std::set<std::array<double, 3>> positions_in(const PointCloud& cloud) {
    std::set<std::array<double, 3>> positions;
    for (const Vec3& p : cloud.positions) positions.insert({p.x(), p.y(), p.z()});
    return positions;
}

TEST(VoxelThin, FivePointsByHand_KeepsTheOneNearestEachCentre) {
    // The grid begins at 0 0 0; voxels of 2; centres at 1 1 1 and 3 1 1.
    const PointCloud cloud = cloud_of({{0, 0, 0}, {1.5, 1, 1}, {0.75, 1, 1}, {2, 0, 0}, {3, 1, 1.25}});
    const VoxelThinResult result = thin(cloud, voxels_of(2));
    EXPECT_THAT(result.kept, ElementsAre(2u, 4u));
    EXPECT_EQ(result.points.positions[0], Vec3(0.75, 1, 1));
    EXPECT_EQ(result.points.positions[1], Vec3(3, 1, 1.25));
    EXPECT_EQ(result.removed, 3u);
    EXPECT_EQ(result.noise, 0u);
    EXPECT_EQ(result.grid_origin, Vec3(0, 0, 0));
}

TEST(VoxelThin, PointOnTheLowFaceOfAVoxel_BelongsToThatVoxel) {
    const PointCloud cloud = cloud_of({{0, 0, 0}, {std::nextafter(2.0, 0.0), 0, 0}, {2, 0, 0}});
    EXPECT_THAT(thin(cloud, voxels_of(2)).kept, ElementsAre(1u, 2u))
        << "the second is slightly nearer the centre of voxel 0 than the first";
}

TEST(VoxelThin, TwoEquallyNear_KeepsTheLowerRow) {
    const PointCloud cloud = cloud_of({{0, 0, 0}, {1.25, 1, 1}, {0.75, 1, 1}, {1, 1.25, 1}});
    EXPECT_THAT(thin(cloud, voxels_of(2)).kept, ElementsAre(1u));
    const PointCloud turned = cloud_of({{0, 0, 0}, {1, 1.25, 1}, {0.75, 1, 1}, {1.25, 1, 1}});
    EXPECT_THAT(thin(turned, voxels_of(2)).kept, ElementsAre(1u));
}

TEST(VoxelThin, Duplicates_CountAsPointsAndTheFirstStays) {
    const PointCloud cloud = cloud_of({{5, 5, 5}, {5, 5, 5}, {5, 5, 5}});
    VoxelThinParams params = voxels_of(1);
    params.min_points = 3;
    EXPECT_THAT(thin(cloud, params).kept, ElementsAre(0u));
}

TEST(VoxelThin, OnePoint_Stays) { EXPECT_THAT(thin(cloud_of({{1, 2, 3}}), voxels_of(0.1)).kept, ElementsAre(0u)); }

TEST(VoxelThin, MinPoints_RemovesAndCountsNoise) {
    // Three, two and one point in voxels 0, 1 and 2.
    const PointCloud cloud = cloud_of({{0, 0, 0}, {1.5, 0, 0}, {2.5, 0, 0}, {0.5, 0, 0}, {1.25, 0, 0}, {0.75, 0, 0}});
    VoxelThinParams params = voxels_of(1);
    EXPECT_THAT(thin(cloud, params).kept, ElementsAre(1u, 2u, 3u));
    params.min_points = 2;
    VoxelThinResult result = thin(cloud, params);
    EXPECT_THAT(result.kept, ElementsAre(1u, 3u));
    EXPECT_EQ(result.noise, 1u);
    EXPECT_EQ(result.removed, 4u);
    params.min_points = 3;
    result = thin(cloud, params);
    EXPECT_THAT(result.kept, ElementsAre(3u));
    EXPECT_EQ(result.noise, 3u);
}

TEST(VoxelThin, Margin_MovesTheGridBelowTheBox) {
    VoxelThinParams params = voxels_of(1);
    params.margin = 0.5;
    // With the margin the first two lie in [-0.5, 0.5), without it in [0, 1).
    const PointCloud cloud = cloud_of({{0, 0, 0}, {0.25, 0, 0}, {1.2, 0, 0}});
    const VoxelThinResult result = thin(cloud, params);
    EXPECT_EQ(result.grid_origin, Vec3(-0.5, -0.5, -0.5));
    EXPECT_THAT(result.kept, ElementsAre(0u, 2u));
    EXPECT_THAT(thin(cloud, voxels_of(1)).kept, ElementsAre(1u, 2u));
}

TEST(VoxelThin, GridOriginInsideTheCloud_RoundsNegativeVoxelsDown) {
    VoxelThinParams params = voxels_of(1);
    params.grid_origin = Vec3(0, 0, 0);
    const PointCloud cloud = cloud_of({{-0.25, 0, 0}, {0.25, 0, 0}, {-1, 0, 0}, {-1.25, 0, 0}});
    EXPECT_THAT(thin(cloud, params).kept, ElementsAre(0u, 1u, 3u)) << "-0.25 and -1 share the voxel [-1, 0)";
}

TEST(VoxelThin, RandomClouds_AgreeWithTheDefinition) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const PointCloud cloud = seed % 2 ? random_sphere(3000, seed) : random_cube(3000, seed);
        VoxelThinParams params = voxels_of(0.03 * static_cast<double>(seed + 1));
        params.min_points = 1 + static_cast<u32>(seed % 4);
        const VoxelThinResult result = thin(cloud, params);
        EXPECT_THAT(result.kept, ::testing::ElementsAreArray(nearest_by_definition(
                                     cloud, result.grid_origin, params.bin_size->value(), params.min_points)))
            << seed;
        EXPECT_EQ(result.kept.size() + result.removed, cloud.size());
    }
}

/// A grid whose voxel numbers take more than 32 bits, and enough points that tables grow and several waves run.
TEST(VoxelThin, ManyPointsInAFineGrid_AgreeWithTheDefinition) {
    const PointCloud cloud = random_cube(1'200'000, 3);
    for (const double size : {1.0 / 2000, 1.0 / 60}) {
        const VoxelThinResult result = thin(cloud, voxels_of(size));
        EXPECT_TRUE(std::ranges::equal(result.kept, nearest_by_definition(cloud, result.grid_origin, size))) << size;
    }
}

TEST(VoxelThin, TwoThreads_GiveTheSameBytes) {
    const PointCloud cloud = random_sphere(300'000, 5, 10);
    const VoxelThinResult one = thin(cloud, voxels_of(0.2), 1), two = thin(cloud, voxels_of(0.2), 2);
    EXPECT_EQ(one.kept, two.kept);
    EXPECT_EQ(one.grid_origin, two.grid_origin);
}

TEST(VoxelThin, ThinningAgainInTheSameGrid_ChangesNothing) {
    const VoxelThinResult once = thin(random_cube(20'000, 1), voxels_of(0.07));
    VoxelThinParams params = voxels_of(0.07);
    params.grid_origin = once.grid_origin;
    const VoxelThinResult twice = thin(once.points, params);
    EXPECT_EQ(twice.removed, 0u);
}

TEST(VoxelThin, ReversedInput_KeepsTheSameSet) {
    const PointCloud cloud = random_cube(20'000, 2);
    std::vector<u32> backwards(cloud.size());
    std::iota(backwards.rbegin(), backwards.rend(), u32(0));
    EXPECT_EQ(positions_in(thin(cloud, voxels_of(0.1)).points),
              positions_in(thin(gather(cloud, backwards), voxels_of(0.1)).points));
}

TEST(VoxelThin, VoxelLargerThanTheCloud_KeepsOnePoint) {
    EXPECT_EQ(thin(random_cube(1000, 1), voxels_of(2)).kept.size(), 1u);
}

TEST(VoxelThin, DenseSphere_OccupiesThreeHalvesOfItsAreaInVoxels) {
    const double size = 0.05;
    const double voxels = 1.5 * 4 * M_PI / (size * size);
    const VoxelThinResult result = thin(random_sphere(2'000'000, 1), voxels_of(size));
    EXPECT_NEAR(static_cast<double>(result.kept.size()) / voxels, 1, 0.02);
}

TEST(VoxelThin, PowersOfTwo_ScaleTheResultAndNothingElse) {
    const PointCloud cloud = random_cube(2000, 6);
    const VoxelThinResult plain = thin(cloud, voxels_of(0.17));
    ASSERT_LT(plain.kept.size(), 400u);
    for (const int exponent : {-29, -10, 10, 29}) {
        Array<Vec3> scaled;
        for (const Vec3& p : cloud.positions) scaled.push_back(p * std::ldexp(1.0, exponent));
        const VoxelThinResult result = thin({{}, std::move(scaled), {}}, voxels_of(std::ldexp(0.17, exponent)));
        EXPECT_EQ(result.kept, plain.kept) << exponent;
    }
}

TEST(VoxelThin, Metrics_CountKeptRemovedAndNoise) {
    VoxelThinParams params = voxels_of(1);
    params.min_points = 2;
    Context context;
    voxel_thin(cloud_of({{0, 0, 0}, {0.5, 0, 0}, {9, 0, 0}}), params, context);
    EXPECT_EQ(context.metrics().find("kept")->value, 1);
    EXPECT_EQ(context.metrics().find("removed")->value, 2);
    EXPECT_EQ(context.metrics().find("noise")->value, 1);
}

TEST(VoxelThin, Cancelled_Stops) {
    ContextOptions options;
    options.is_cancelled = [] { return true; };
    Context context(options);
    EXPECT_THROW(voxel_thin(random_cube(100, 1), voxels_of(1), context), Cancelled);
}

TEST(VoxelThin, CornersOfTheLargestGrid_AreToldApart) {
    const double far = (1 << 21) - 1;
    const PointCloud corners = cloud_of({{0, 0, 0},
                                         {far, 0, 0},
                                         {0, far, 0},
                                         {0, 0, far},
                                         {far, far, 0},
                                         {far, 0, far},
                                         {0, far, far},
                                         {far, far, far}});
    EXPECT_EQ(thin(corners, voxels_of(1)).kept.size(), 8u);
}

TEST(VoxelThin, RealScan_AgreesWithTheDefinition) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/bunny00.off");
    const auto cloud = read_points(path);
    const double size = 0.02 * bounding_box(cloud->positions.span()).diagonal();
    const VoxelThinResult result = thin(*cloud, voxels_of(size), 2);
    EXPECT_GT(result.removed, cloud->size() / 2);
    EXPECT_TRUE(std::ranges::equal(result.kept, nearest_by_definition(*cloud, result.grid_origin, size)));
}

}  // namespace
}  // namespace scanmill::test
