// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <limits>

#include "filters/region_grow/cases.hpp"
#include "support/doubts.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

PointCloud with_normals(PointCloud cloud, const std::vector<Vec3>& normals) {
    Array<double> numbers;
    for (const Vec3& n : normals) numbers.insert(numbers.end(), n.begin(), n.end());
    cloud.columns.add(Column("normal", 3, Buffer<double>(std::move(numbers))));
    return cloud;
}

TEST(RegionGrowRefuses, NoPoint) {
    EXPECT_THAT(growth_refusal({}), AllOf(HasSubstr("the cloud has none"), HasSubstr("hint")));
}

TEST(RegionGrowRefuses, OneAndTwoPoints) {
    EXPECT_THAT(growth_refusal(cloud_of({{1, 2, 3}})), HasSubstr("at least 3 distinct points; the cloud has 1 in 1"));
    EXPECT_THAT(growth_refusal(cloud_of({{1, 2, 3}, {0, 0, 1}, {1, 2, 3}})),
                AllOf(HasSubstr("the cloud has 2 in 3 rows"), HasSubstr("hint")));
}

TEST(RegionGrowRefuses, PointsOnALine) {
    EXPECT_THAT(growth_refusal(cloud_of({{0, 0, 0}, {1, 2, 3}, {2, 4, 6}, {-3, -6, -9}})),
                AllOf(HasSubstr("all 4 distinct points lie on one line"), HasSubstr("hint")));
}

TEST(RegionGrowRefuses, NotFiniteCoordinates) {
    EXPECT_THAT(growth_refusal(cloud_of({{0, 0, 0}, {1, nan, 0}, {0, 1, 0}, {1, 1, 0}})), HasSubstr("1 of 4 points"));
}

TEST(RegionGrowRefuses, NormalsOfTwoNumbers) {
    PointCloud cloud = grid(3, 3);
    cloud.columns.add(Column("normal", 2, Buffer<double>(Array<double>(18))));
    EXPECT_THAT(growth_refusal(cloud), AllOf(HasSubstr("2 numbers per row"), HasSubstr("3 numbers in each of the 9")));
}

TEST(RegionGrowRefuses, ParametersOutOfRange) {
    RegionGrowParams params;
    params.min_angle = Angle::degrees(60);
    EXPECT_THAT(growth_refusal(grid(3, 3), params), AllOf(HasSubstr("min-angle is 60"), HasSubstr("hint")));
    params = with_max_normal_angle(0);
    EXPECT_THAT(growth_refusal(grid(3, 3), params), AllOf(HasSubstr("max-normal-angle is 0"), HasSubstr("hint")));
    params = {};
    params.search_radius = Length(0);
    EXPECT_THAT(growth_refusal(grid(3, 3), params), AllOf(HasSubstr("search-radius is 0"), HasSubstr("hint")));
    params = {};
    params.close_holes = 101;
    EXPECT_THAT(growth_refusal(grid(3, 3), params), AllOf(HasSubstr("close-holes is 101"), HasSubstr("hint")));
    params = {};
    for (const double noise : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
        params.noise = Length(noise);
        EXPECT_THAT(growth_refusal(grid(3, 3), params),
                    AllOf(HasSubstr("noise is"), HasSubstr("it must be at least 0"), HasSubstr("leave noise out")));
    }
}

TEST(RegionGrowRefuses, AStartThatIsNoRowOrStartsNothing) {
    RegionGrowParams params;
    params.start = 9;
    EXPECT_THAT(growth_refusal(grid(3, 3), params),
                AllOf(HasSubstr("start is row 9; the cloud has 9 points"), HasSubstr("hint")));
    params.start = 9;
    EXPECT_THAT(growth_refusal(joined(grid(3, 3), cloud_of({{100, 100, 50}})), params), HasSubstr("at row 9"));
}

TEST(RegionGrowRefuses, ASearchRadiusBelowTheSpacing) {
    RegionGrowParams params;
    params.search_radius = Length(0.5);
    EXPECT_THAT(growth_refusal(grid(5, 5), params), AllOf(HasSubstr("search-radius 0.5 u"), HasSubstr("enlarge")));
}

TEST(RegionGrow_GivenNormals, DecideWhichSideIsUp) {
    const std::vector<Vec3> down(9, Vec3(0, 0, -2));
    const RegionGrowResult result = grown(with_normals(grid(3, 3), down));
    EXPECT_EQ(result.mesh.triangles.size(), 8u);
    for (const Triangle& t : result.mesh.triangles) EXPECT_LT(normal_of(result.mesh, t).z(), 0);
}

TEST(RegionGrow_GivenNormals, ThatHaveNoDirectionAreReplaced) {
    std::vector<Vec3> normals(9, Vec3(0, 0, -1));
    normals[4] = Vec3::Zero();
    normals[2] = Vec3(0, nan, 1);
    ContextOptions options;
    Context context(options);
    const RegionGrowResult result = region_grow(with_normals(grid(3, 3), normals), {}, context);
    EXPECT_EQ(result.mesh.triangles.size(), 8u);
    for (const Triangle& t : result.mesh.triangles) EXPECT_LT(normal_of(result.mesh, t).z(), 0);
    ASSERT_EQ(context.warnings().size(), 1u);
    EXPECT_THAT(context.warnings()[0], HasSubstr("2 of 9 normals are zero or not finite"));
}

TEST(RegionGrow_GivenNormals, AllZeroAreIgnored) {
    Context context;
    const RegionGrowResult result =
        region_grow(with_normals(grid(3, 3), std::vector<Vec3>(9, Vec3::Zero())), {}, context);
    EXPECT_EQ(result.mesh.triangles.size(), 8u);
    EXPECT_THAT(context.warnings()[0], HasSubstr("all 9 normals are zero or not finite"));
}

TEST(RegionGrow_IsolatedPoints, AreCountedAsUnused) {
    Context context;
    const RegionGrowResult result =
        region_grow(joined(grid(6, 6), cloud_of({{100, 0, 0}, {0, 0, 50}, {-80, 3, 7}})), {}, context);
    EXPECT_EQ(result.unused_points, 3u);
    EXPECT_EQ(result.mesh.positions.size(), 36u);
    EXPECT_THAT(doubts_of(context), testing::ElementsAre(HasSubstr("3 of 39 distinct points are in no triangle")));
}

}  // namespace
}  // namespace scanmill
