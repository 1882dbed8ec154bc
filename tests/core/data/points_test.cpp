// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scanmill/base/random.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using ::testing::AllOf, ::testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

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

}  // namespace
}  // namespace scanmill::test
