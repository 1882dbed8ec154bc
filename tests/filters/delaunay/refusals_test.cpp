// SPDX-License-Identifier: GPL-3.0-or-later
// Clouds without a triangulation are refused, with the numbers found.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <limits>

#include "delaunay/delaunay.hpp"
#include "scanmill/base/error.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;

DelaunayResult triangulated(const PointCloud& cloud, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return delaunay(cloud, {}, context);
}

std::string refusal(const PointCloud& cloud) {
    try {
        triangulated(cloud);
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

TEST(Delaunay, NaNOrInfinity_IsRefusedWithItsRow) {
    PointCloud cloud = random_cube(10, 1);
    Array<Vec3> positions(cloud.positions.begin(), cloud.positions.end());
    positions[7].y() = std::numeric_limits<double>::quiet_NaN();
    positions[8].x() = std::numeric_limits<double>::infinity();
    cloud.positions = std::move(positions);
    EXPECT_THAT(refusal(cloud), HasSubstr("2 of 10 points have a NaN or an infinity, the first is number 7"));
}

TEST(Delaunay, TooFewPoints_AreRefused) {
    const auto has_the_hint = HasSubstr("hint: `scanmill info` gives the number of points in a file");
    EXPECT_THAT(refusal(cloud_of({})), testing::AllOf(HasSubstr("the cloud has 0"), has_the_hint));
    EXPECT_THAT(refusal(cloud_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})),
                HasSubstr("at least 4 points that are not coplanar"));
}

TEST(Delaunay, TooFewDistinctPoints_AreRefusedWithBothNumbers) {
    const std::string text = refusal(cloud_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}}));
    EXPECT_THAT(text, HasSubstr("the cloud has 5 points at 3 distinct positions"));
    EXPECT_THAT(text, HasSubstr("hint: "));
}

TEST(Delaunay, EqualPoints_AreRefused_AsOnePosition) {
    EXPECT_THAT(refusal(cloud_of({{3, 4, 5}, {3, 4, 5}, {3, 4, 5}, {3, 4, 5}, {3, 4, 5}})),
                HasSubstr("the cloud has 5 points at 1 distinct position"));
}

TEST(Delaunay, CollinearPoints_AreRefused) {
    Array<Vec3> positions(20);
    for (int i = 0; i < 20; ++i) positions[i] = Vec3(1, 2, 3) * i;
    PointCloud cloud;
    cloud.positions = std::move(positions);
    const std::string text = refusal(cloud);
    EXPECT_THAT(text, HasSubstr("the cloud has 20, all within"));
    EXPECT_THAT(text, HasSubstr("of one line"));
}

TEST(Delaunay, CoplanarPoints_AreRefusedWithAHint) {
    Array<Vec3> positions;
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) positions.push_back(Vec3(i, j, 2 * i - j));
    PointCloud cloud;
    cloud.positions = std::move(positions);
    const std::string text = refusal(cloud);
    EXPECT_THAT(text, HasSubstr("the cloud has 64, all within"));
    EXPECT_THAT(text, HasSubstr("u of one plane"));
    EXPECT_THAT(text, HasSubstr("hint: region-grow makes a surface of flat scans"));
}

TEST(Delaunay, PlaneThatWasRotated_IsRefused_BecauseItsThicknessIsRounding) {
    for (double angle : {0.1, 0.7, 2.0}) {
        const std::string text = refusal(rotated(flat_square(0), angle));
        EXPECT_THAT(text, HasSubstr("of one plane, less than their coordinates can express")) << angle;
    }
}

TEST(Delaunay, PlaneFarFromTheWorldsOrigin_CountsTheRoundingThere) {
    // At 10^6 the unit in the last place of a coordinate is 1.2e-10: this thickness cannot have been measured.
    PointCloud cloud = rotated(flat_square(1e-10), 0.7);
    EXPECT_EQ(refusal(cloud), "accepted");
    cloud.frame.origin = Vec3(1e6, 0, 0);
    EXPECT_THAT(refusal(cloud), HasSubstr("less than their coordinates can express"));
}

TEST(Delaunay, ScanThatLostItsDigitsFarAway_IsRefusedWithTheHintToMoveIt) {
    PointCloud cloud = random_cube(50, 1);
    cloud.frame.origin = Vec3(1e16, 0, 0);
    EXPECT_THAT(refusal(cloud), AllOf(HasSubstr("of one position"), HasSubstr("hint: move the scan near the origin")));
}

}  // namespace
}  // namespace scanmill
