// SPDX-License-Identifier: GPL-3.0-or-later
/// One test per refusal of voxel-thin.
#include <gmock/gmock.h>

#include <limits>

#include "filters/voxel_thin/cases.hpp"
#include "scanmill/base/error.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using ::testing::HasSubstr;

std::string refusal(const PointCloud& cloud, const VoxelThinParams& params) {
    try {
        thin(cloud, params);
    } catch (const Error& error) {
        return error.what();
    }
    return "no refusal";
}

TEST(VoxelThinRefusals, EmptyCloud_IsRefused) {
    EXPECT_THAT(refusal(PointCloud{}, voxels_of(1)), HasSubstr("0 points"));
}

TEST(VoxelThinRefusals, NotANumber_IsRefusedWithItsRow) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}, {1, nan, 0}}), voxels_of(1)), HasSubstr("1 of 2 points"));
}

TEST(VoxelThinRefusals, InfinityOfEitherSign_IsRefused) {
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_THAT(refusal(cloud_of({{0, 0, infinity}, {1, 0, 0}}), voxels_of(1)), HasSubstr("finite"));
    EXPECT_THAT(refusal(cloud_of({{0, -infinity, 0}, {1, 0, 0}}), voxels_of(1)), HasSubstr("finite"));
}

TEST(VoxelThinRefusals, BinSizeNotAboveZero_IsRefused) {
    const PointCloud cloud = cloud_of({{0, 0, 0}});
    EXPECT_THAT(refusal(cloud, voxels_of(0)), HasSubstr("bin-size is 0"));
    EXPECT_THAT(refusal(cloud, voxels_of(-1)), HasSubstr("bin-size is -1"));
    EXPECT_THAT(refusal(cloud, voxels_of(std::numeric_limits<double>::quiet_NaN())), HasSubstr("above 0"));
    EXPECT_THAT(refusal(cloud, voxels_of(std::numeric_limits<double>::infinity())), HasSubstr("above 0"));
}

TEST(VoxelThinRefusals, UnresolvedBinSize_IsRefused) {
    VoxelThinParams params;
    params.bin_size = Length::percent_of_diagonal(1);
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}}), params), HasSubstr("not resolved"));
}

TEST(VoxelThinRefusals, NegativeMargin_IsRefused) {
    VoxelThinParams params = voxels_of(1);
    params.margin = -1;
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}}), params), HasSubstr("margin is -1"));
}

TEST(VoxelThinRefusals, NoMinimumOfPoints_IsRefused) {
    VoxelThinParams params = voxels_of(1);
    params.min_points = 0;
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}}), params), HasSubstr("min-points is 0"));
}

TEST(VoxelThinRefusals, MoreThanTwoToThe21VoxelsAlongAnAxis_AreRefused) {
    const double most = 1 << 21;
    EXPECT_EQ(thin(cloud_of({{0, 0, 0}, {0, most - 1, 0}}), voxels_of(1)).kept.size(), 2u);
    const PointCloud long_cloud = cloud_of({{0, 0, 0}, {0, most, 0}});
    EXPECT_THAT(refusal(long_cloud, voxels_of(1)), HasSubstr("2097153; at most 2097152"));
    EXPECT_THAT(refusal(long_cloud, voxels_of(1)), HasSubstr("along y"));
}

TEST(VoxelThinRefusals, TooSmallVoxels_TheNamedSizeFits) {
    const PointCloud cloud = cloud_of({{0, 0, 0}, {0, 12345.678, 9}});
    const std::string text = refusal(cloud, voxels_of(1e-6));
    const std::string before = "a bin-size of at least ";
    const std::size_t at = text.find(before);
    ASSERT_NE(at, std::string::npos) << text;
    double smallest = 0;
    ASSERT_TRUE(parse_number(text.substr(at + before.size(), text.find(" u", at) - at - before.size()), smallest))
        << text;
    EXPECT_EQ(thin(cloud, voxels_of(smallest)).kept.size(), 2u);
    EXPECT_NE(refusal(cloud, voxels_of(smallest * 0.999)), "no refusal");
}

TEST(VoxelThinRefusals, DistantGridOrigin_IsRefused) {
    VoxelThinParams params = voxels_of(1);
    params.grid_origin = Vec3(0, 0, 1e10);
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}}), params), HasSubstr("voxels of 1 u away"));
    params.grid_origin = Vec3(0, 0, std::numeric_limits<double>::quiet_NaN());
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}}), params), HasSubstr("not finite"));
}

TEST(VoxelThinRefusals, NothingButNoise_IsRefused) {
    VoxelThinParams params = voxels_of(1);
    params.min_points = 2;
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}, {5, 0, 0}}), params), HasSubstr("all 2 points lie in 2 voxels"));
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}}), params), HasSubstr("the only point lies in 1 voxel with fewer than 2"));
}

TEST(VoxelThinRefusals, ToleranceNotAboveZero_IsRefused) {
    const PointCloud sphere = random_sphere(100, 1);
    EXPECT_THAT(refusal(sphere, within(0)), HasSubstr("tolerance is 0 u; it must be above 0"));
    EXPECT_THAT(refusal(sphere, within(std::numeric_limits<double>::quiet_NaN())), HasSubstr("above 0"));
    EXPECT_THAT(refusal(sphere, VoxelThinParams{}), HasSubstr("not resolved"));
}

TEST(VoxelThinRefusals, ToleranceLargerThanTheObject_IsRefusedWithItsSize) {
    const PointCloud cloud = joined(random_sphere(100, 1, 0.5), cloud_of({{0, 0, -4}, {0, 3, 4}}));
    EXPECT_THAT(refusal(cloud, within(20)),
                HasSubstr("tolerance is 20 u, which is not below the cloud's diagonal of 8.7"));
}

TEST(VoxelThinRefusals, FewerPointsThanNeighbours_IsRefusedWithAWayOut) {
    const PointCloud few = random_sphere(25, 1);
    EXPECT_THAT(refusal(few, within(0.1)),
                HasSubstr("25 distinct points; curvature from 25 neighbours needs at least 26"));
    EXPECT_THAT(refusal(joined(few, few), within(0.1)), HasSubstr("25 distinct points"));
    EXPECT_THAT(refusal(few, within(0.1)), HasSubstr("hint: give a bin-size, or fewer neighbours"));
    VoxelThinParams fewer = within(0.1);
    fewer.neighbours = 24;
    EXPECT_EQ(refusal(few, fewer), "no refusal");
    EXPECT_EQ(refusal(random_sphere(26, 1), within(0.1)), "no refusal");
    EXPECT_THAT(refusal(cloud_of({{1, 2, 3}}), within(1e-3)), HasSubstr("diagonal of 0 u"));
}

TEST(VoxelThinRefusals, FewerThanSixNeighboursOrThousands_AreRefused) {
    VoxelThinParams params = within(0.1);
    params.neighbours = 5;
    EXPECT_THAT(refusal(random_sphere(100, 1), params), HasSubstr("neighbours is 5; a quadric needs at least 6"));
    params.neighbours = 1001;
    EXPECT_THAT(refusal(random_sphere(2000, 1), params), HasSubstr("neighbours is 1001; at most 1000"));
}

TEST(VoxelThinRefusals, QuantileOutsideOf0To1_IsRefused) {
    VoxelThinParams params = within(0.1);
    params.quantile = Ratio::percent(101);
    EXPECT_THAT(refusal(random_sphere(100, 1), params), HasSubstr("quantile is 1.01"));
    params.quantile = Ratio::fraction(-0.5);
    EXPECT_THAT(refusal(random_sphere(100, 1), params), HasSubstr("quantile is -0.5"));
}

TEST(VoxelThinRefusals, PointsOnOneLine_AreRefused) {
    Array<Vec3> line;
    for (int i = 0; i < 100; ++i) line.push_back(Vec3(i, 2 * i, -i));
    EXPECT_THAT(refusal({{}, std::move(line), {}}, within(1)),
                HasSubstr("no point has 25 neighbours that determine a surface"));
}

TEST(VoxelThinRefusals, AdaptiveRuleWithAGivenGrid_IsRefused) {
    VoxelThinParams params = within(0.1, VoxelThinParams::Rule::adaptive);
    params.bin_size = 0.5;
    EXPECT_THAT(refusal(random_sphere(100, 1), params),
                HasSubstr("rule is adaptive, which derives voxel sizes, but bin-size is 0.5 u"));
    params.bin_size.reset();
    params.grid_origin = Vec3::Zero();
    EXPECT_THAT(refusal(random_sphere(100, 1), params),
                HasSubstr("rule is adaptive, whose octree begins at the bounding box"));
}

}  // namespace
}  // namespace scanmill::test
