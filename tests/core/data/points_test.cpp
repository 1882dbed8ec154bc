// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scanmill/base/random.hpp"
#include "support/numbers.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using ::testing::AllOf, ::testing::ElementsAre, ::testing::HasSubstr;

TEST(PointGather, Rows_BringTheirColumnsAndTheFrame) {
    PointCloud cloud = cloud_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
    cloud.frame = {LengthUnit::metre, Vec3(100, 0, 0), "site"};
    cloud.columns.add(Column("weight", 1, Buffer<float>{10, 11, 12}));
    const std::vector<u32> rows{2, 0};
    const PointCloud picked = gather(cloud, rows);
    EXPECT_EQ(picked.size(), 2u);
    EXPECT_EQ(picked.positions[0], Vec3(2, 0, 0));
    EXPECT_EQ(picked.positions[1], Vec3(0, 0, 0));
    EXPECT_EQ(picked.columns.find("weight")->number(0), 12);
    EXPECT_EQ(picked.columns.find("weight")->number(1), 10);
    EXPECT_EQ(picked.frame, cloud.frame);
}

TEST(RequireFinite, FinitePositions_Pass) {
    EXPECT_NO_THROW(require_finite(random_cube(100, 1).positions.span()));
    EXPECT_NO_THROW(require_finite({}));
    const std::vector<Vec3> largest{Vec3::Constant(std::numeric_limits<double>::max())};
    EXPECT_NO_THROW(require_finite(largest));
}

TEST(RequireFinite, NanAndInfinity_AreCountedAndTheFirstIsNamed) {
    const std::vector<Vec3> positions{{0, 0, 0}, {1, nan, 2}, {3, 4, 5}, {-infinity, 0, 0}};
    const Error error = error_of([&] { require_finite(positions, "vertices"); });
    EXPECT_EQ(error.sentence(),
              "needs finite coordinates; 2 of 4 vertices have a NaN or an infinity, the first is number 1 (y is nan)");
    EXPECT_EQ(error.remedy(), Remedy::drop_invalid_points);
}

TEST(RequireFinite, EveryCoordinate_IsLookedAt) {
    for (int axis = 0; axis < 3; ++axis)
        for (const double bad : {nan, infinity, -infinity}) {
            std::vector<Vec3> positions(3, Vec3::Zero());
            positions[2][axis] = bad;
            EXPECT_THROW(require_finite(positions), Error) << axis << ' ' << bad;
        }
}

TEST(BoundingBox, Points_AreBoundedPerAxis) {
    const std::vector<Vec3> positions{{1, -5, 3}, {-2, 4, 3}, {0, 0, 3}};
    const BoundingBox box = bounding_box(positions);
    EXPECT_EQ(box.low, Vec3(-2, -5, 3));
    EXPECT_EQ(box.high, Vec3(1, 4, 3));
    EXPECT_FALSE(box.empty());
    EXPECT_DOUBLE_EQ(box.diagonal(), std::sqrt(90.0));
}

TEST(BoundingBox, OnePoint_IsABoxWithoutDiagonal) {
    const std::vector<Vec3> positions{{7, 8, 9}};
    const BoundingBox box = bounding_box(positions);
    EXPECT_FALSE(box.empty());
    EXPECT_EQ(box.low, box.high);
    EXPECT_EQ(box.diagonal(), 0);
}

TEST(BoundingBox, PointWithANanAnywhere_CountsWithNoCoordinate) {
    const std::vector<Vec3> positions{{nan, 100, 100}, {0, 0, 0}, {-100, infinity, 0}, {3, 4, 0}, {9, 9, nan}};
    const BoundingBox box = bounding_box(positions);
    EXPECT_EQ(box.low, Vec3(0, 0, 0));
    EXPECT_EQ(box.high, Vec3(3, 4, 0));
    EXPECT_EQ(box.diagonal(), 5);
}

TEST(BoundingBox, NothingFinite_IsEmpty) {
    EXPECT_TRUE(bounding_box({}).empty());
    const std::vector<Vec3> positions{{nan, 0, 0}};
    EXPECT_TRUE(bounding_box(positions).empty());
    EXPECT_EQ(bounding_box(positions).diagonal(), 0);
}

TEST(Translated, Shift_IsAddedToEveryPosition) {
    const Buffer<Vec3> moved = translated({Vec3(1, 2, 3), Vec3(0, 0, 0)}, Vec3(10, 20, 30));
    EXPECT_EQ(moved[0], Vec3(11, 22, 33));
    EXPECT_EQ(moved[1], Vec3(10, 20, 30));
}

TEST(SupportedRange, SidesOutsideOneNanoUnitToOneGigaUnit_AreRefusedWithTheirRange) {
    const auto box = [](double low, double high) { return BoundingBox{Vec3(low, 0, 0), Vec3(high, 0, 0)}; };
    for (const BoundingBox& supported : {box(0, 0), box(5e12, 5e12), box(0, 1e-9), box(-5e8, 5e8), BoundingBox{}})
        EXPECT_NO_THROW(require_supported_range(supported));
    EXPECT_THAT(sentence_of([&] { require_supported_range(box(-1e9, 1)); }),
                AllOf(HasSubstr("from -1e+09 to 1 in x"), HasSubstr("supported are 1e-09 to 1e+09")));
    EXPECT_THAT(sentence_of([&] { require_supported_range(box(0, 0.99e-9)); }), HasSubstr("supported are"));
    EXPECT_THAT(sentence_of([&] { require_supported_range(box(-1.5e308, 1.5e308)); }), HasSubstr("supported are"));
}

std::vector<u32> valid(const std::vector<Vec3>& positions) {
    const Array<u32> rows = valid_rows(positions);
    return {rows.begin(), rows.end()};
}

TEST(IsTooLong, Box_IsIfASideIsAboveOneGigaUnit) {
    const auto box = [](const Vec3& high) { return BoundingBox{Vec3::Zero(), high}; };
    EXPECT_FALSE(is_too_long(BoundingBox{}));
    EXPECT_FALSE(is_too_long(box({1, 1e9, 1e9})));
    for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(is_too_long(box(std::nextafter(1e9, 2e9) * Vec3::Unit(axis))));
    EXPECT_TRUE(is_too_long({Vec3::Constant(-1.5e308), Vec3::Constant(1.5e308)}));
}

TEST(ValidRows, NotFiniteRows_AreInvalid) {
    EXPECT_THAT(valid({{0, 0, 0}, {1, nan, 2}, {3, 4, 5}, {-infinity, 0, 0}}), ElementsAre(0u, 2u));
    EXPECT_THAT(valid({{nan, 0, 0}}), testing::IsEmpty());
}

TEST(ValidRows, RowsFarFromTheMedianOfAScanThatIsTooLong_AreInvalid) {
    EXPECT_THAT(valid({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1e300, 0}}), ElementsAre(0u, 1u, 2u));
    EXPECT_THAT(valid({{4e9, 0, 0}, {4e9, 1, 0}, {4e9 + 1, 0, 0}, {0, 0, 0}}), ElementsAre(0u, 1u, 2u));
    EXPECT_THAT(valid({{0, 0, 0}, {0, 0, 0}, {0, 0, 5e8}, {0, 0, -5e8}, {0, 6e8, 0}, {0, -6e8, 0}}),
                ElementsAre(0u, 1u, 2u, 3u));
}

TEST(ValidRows, ScanOfTheLongestLength_HasNoInvalidRow) {
    EXPECT_THAT(valid({{0, 0, 0}, {1, 0, 0}, {1e9, 0, 0}}), ElementsAre(0u, 1u, 2u));
}

TEST(ValidRows, ScanOfWhichHalfIsFar_IsTooLongItself) {
    const std::vector<Vec3> spread{{0, 0, 0}, {1e9, 0, 0}, {2e9, 0, 0}, {3e9, 0, 0}};
    EXPECT_THAT(sentence_of([&] { valid_rows(spread); }),
                AllOf(HasSubstr("supported are"), HasSubstr("3 of 4 points lie farther than 5e+08 u from the median")));
}

TEST(Accepted, InvalidRows_AreRefusedWithTheWayOutOrDropped) {
    PointCloud cloud = cloud_of({{0, 0, 0}, {nan, 0, 0}, {2, 0, 0}});
    cloud.columns.add(Column("weight", 1, Buffer<float>{10, 11, 12}));
    for (const bool no_return : {false, true}) {
        const Error error = error_of([&] { accepted(cloud, InvalidRows::refuse, no_return); });
        EXPECT_THAT(error.sentence(), HasSubstr("1 of 3 points has a NaN"));
        EXPECT_EQ(error.remedy(), Remedy::drop_invalid_rows);
        const auto dropped = accepted(cloud, InvalidRows::drop, no_return);
        EXPECT_EQ(dropped.points, 1u);
        EXPECT_EQ(dropped.result.size(), 2u);
        EXPECT_EQ(dropped.result.columns.find("weight")->number(1), 12);
    }
    EXPECT_THROW(accepted(cloud, InvalidRows::by_format, false), Error);
    EXPECT_EQ(accepted(cloud, InvalidRows::by_format, true).points, 1u);
}

TEST(Accepted, FarRow_IsRefusedWithItsPositionOrDropped) {
    PointCloud cloud = cloud_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 3e12, 0}});
    cloud.frame.origin = Vec3(7, 0, 0);
    const Error error = error_of([&] { accepted(cloud, InvalidRows::by_format, false); });
    EXPECT_THAT(error.sentence(),
                AllOf(HasSubstr("1 of 4 points lies farther than"), HasSubstr("number 3 at (9, 3e+12, 0)")));
    EXPECT_EQ(error.remedy(), Remedy::drop_invalid_rows);
    EXPECT_EQ(accepted(cloud, InvalidRows::drop, false).points, 1u);
}

TEST(Accepted, ValidScan_IsUnchanged) {
    const PointCloud cloud = random_cube(100, 1);
    const auto same = accepted(cloud, InvalidRows::drop, true);
    EXPECT_EQ(same.points, 0u);
    EXPECT_EQ(same.result.positions.data(), cloud.positions.data());
}

TEST(Accepted, OneValidRow_IsAScanAndNoneIsRefused) {
    EXPECT_EQ(accepted(cloud_of({{nan, 0, 0}, {1, 2, 3}}), InvalidRows::drop, false).result.size(), 1u);
    const PointCloud none = cloud_of({{nan, 0, 0}, {1, 2, infinity}});
    EXPECT_THAT(sentence_of([&] { accepted(none, InvalidRows::drop, false); }),
                HasSubstr("all 2 points have a NaN or an infinity"));
    EXPECT_THAT(sentence_of([&] { accepted(none, InvalidRows::by_format, true); }), HasSubstr("no point is left"));
}

TEST(Accepted, TooShortScan_IsRefused) {
    EXPECT_THAT(sentence_of([&] {
                    accepted(cloud_of({{0, 0, 0}, {0, 1e-10, 0}}), InvalidRows::drop, false);
                }),
                HasSubstr("supported are"));
}

}  // namespace
}  // namespace scanmill::test
