// SPDX-License-Identifier: GPL-3.0-or-later
/// Everything that voxel-thin refuses.
#include <gmock/gmock.h>

#include <limits>

#include "filters/voxel_thin_cases.hpp"
#include "scanmill/filter/error.hpp"
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
    EXPECT_THAT(refusal(PointCloud{}, bins_of(1)), HasSubstr("no points"));
}

TEST(VoxelThinRefusals, NotANumber_IsRefusedWithItsRow) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}, {1, nan, 0}}), bins_of(1)), HasSubstr("1 of 2 points"));
}

TEST(VoxelThinRefusals, InfinityOfEitherSign_IsRefused) {
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_THAT(refusal(cloud_of({{0, 0, infinity}, {1, 0, 0}}), bins_of(1)), HasSubstr("finite"));
    EXPECT_THAT(refusal(cloud_of({{0, -infinity, 0}, {1, 0, 0}}), bins_of(1)), HasSubstr("finite"));
}

TEST(VoxelThinRefusals, BinSizeNotAboveZero_IsRefused) {
    const PointCloud cloud = cloud_of({{0, 0, 0}});
    EXPECT_THAT(refusal(cloud, VoxelThinParams{}), HasSubstr("bin size is 0"));
    EXPECT_THAT(refusal(cloud, bins_of(-1)), HasSubstr("bin size is -1"));
    EXPECT_THAT(refusal(cloud, bins_of(std::numeric_limits<double>::quiet_NaN())), HasSubstr("above 0"));
    EXPECT_THAT(refusal(cloud, bins_of(std::numeric_limits<double>::infinity())), HasSubstr("above 0"));
}

TEST(VoxelThinRefusals, UnresolvedBinSize_IsRefused) {
    VoxelThinParams params;
    params.bin_size = Length::percent_of_diagonal(1);
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}}), params), HasSubstr("not resolved"));
}

TEST(VoxelThinRefusals, NegativeMargin_IsRefused) {
    VoxelThinParams params = bins_of(1);
    params.margin = -1;
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}}), params), HasSubstr("margin is -1"));
}

TEST(VoxelThinRefusals, NoMinimumOfPoints_IsRefused) {
    VoxelThinParams params = bins_of(1);
    params.min_points = 0;
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}}), params), HasSubstr("min-points is 0"));
}

TEST(VoxelThinRefusals, TwoToThe21BinsAlongAnAxis_AreTheMost) {
    const double most = 1 << 21;
    EXPECT_EQ(thin(cloud_of({{0, 0, 0}, {0, most - 1, 0}}), bins_of(1)).kept.size(), 2u);
    const PointCloud long_cloud = cloud_of({{0, 0, 0}, {0, most, 0}});
    EXPECT_THAT(refusal(long_cloud, bins_of(1)), HasSubstr("2097153; at most 2097152"));
    EXPECT_THAT(refusal(long_cloud, bins_of(1)), HasSubstr("along y"));
}

TEST(VoxelThinRefusals, TooFineBins_NamedSmallestSizeFits) {
    const PointCloud cloud = cloud_of({{0, 0, 0}, {0, 12345.678, 9}});
    const std::string text = refusal(cloud, bins_of(1e-6));
    const std::size_t at = text.find("bins of ", text.find("hint"));
    ASSERT_NE(at, std::string::npos) << text;
    double smallest = 0;
    ASSERT_TRUE(parse_number(text.substr(at + 8, text.find(" u", at) - at - 8), smallest)) << text;
    EXPECT_EQ(thin(cloud, bins_of(smallest)).kept.size(), 2u);
    EXPECT_NE(refusal(cloud, bins_of(smallest * 0.999)), "no refusal");
}

TEST(VoxelThinRefusals, DistantGridOrigin_IsRefused) {
    VoxelThinParams params = bins_of(1);
    params.grid_origin = Vec3(0, 0, 1e10);
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}}), params), HasSubstr("bins of 1 u away"));
    params.grid_origin = Vec3(0, 0, std::numeric_limits<double>::quiet_NaN());
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}}), params), HasSubstr("not finite"));
}

TEST(VoxelThinRefusals, NothingButNoise_IsRefused) {
    VoxelThinParams params = bins_of(1);
    params.min_points = 2;
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}, {5, 0, 0}}), params), HasSubstr("all 2 points lie in 2 bins"));
}

}  // namespace
}  // namespace scanmill::test
