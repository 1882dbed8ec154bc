// SPDX-License-Identifier: GPL-3.0-or-later
/// Refusals of outlier-removal, and unusual clouds that it accepts.
#include <gmock/gmock.h>

#include <limits>

#include "filters/outlier_removal/cases.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The sentence of a refusal, which must have a hint.
std::string refusal(const PointCloud& cloud, const OutlierRemovalParams& params = {}) {
    const Error error = error_of([&] { clean(cloud, params); });
    EXPECT_THAT(error.hint(), Not(IsEmpty()));
    return error.sentence();
}

const PointCloud three = on_a_line({0, 1, 2});

TEST(OutlierRemovalRefusals, EmptyCloud_IsRefused) {
    EXPECT_EQ(refusal(PointCloud{}), "the cloud has 0 points; outlier removal needs at least 1");
}

TEST(OutlierRemovalRefusals, NotFinite_IsRefusedWithCountAndRow) {
    EXPECT_THAT(sentence_of([] { clean(on_a_line({0, nan, 1})); }), HasSubstr("1 of 3 points"));
    EXPECT_THAT(sentence_of([] { clean(on_a_line({0, 1, -infinity})); }), HasSubstr("1 of 3 points"));
}

TEST(OutlierRemovalRefusals, NeighboursOutOfRange_AreRefused) {
    EXPECT_EQ(refusal(three, suspects_only(0)), "neighbours is 0; it must be from 1 to 1000");
    EXPECT_EQ(refusal(three, suspects_only(1001)), "neighbours is 1001; it must be from 1 to 1000");
}

TEST(OutlierRemovalRefusals, FactorNotAboveZero_IsRefused) {
    EXPECT_EQ(refusal(three, suspects_only(1, 0)), "factor is 0; it must be above 0");
    EXPECT_THAT(refusal(three, suspects_only(1, nan)), HasSubstr("above 0"));
    EXPECT_THAT(refusal(three, suspects_only(1, infinity)), HasSubstr("above 0"));
}

TEST(OutlierRemovalRefusals, RadiusBelowZero_IsRefused) {
    EXPECT_EQ(refusal(three, by_radius(1, -1)), "radius is -1 u; it must be 0 or more");
    EXPECT_THAT(refusal(three, by_radius(1, nan)), HasSubstr("0 or more"));
}

TEST(OutlierRemovalRefusals, UnresolvedRadius_IsRefused) {
    OutlierRemovalParams params;
    params.radius = Length::percent_of_diagonal(1);
    EXPECT_THAT(refusal(three, params), HasSubstr("not resolved"));
}

TEST(OutlierRemovalRefusals, ShareOutOfRange_IsRefused) {
    OutlierRemovalParams params;
    params.min_component = Ratio::percent(101);
    EXPECT_EQ(refusal(three, params), "min-component is 1.01; it must be from 0 to 1");
    params.min_component = Ratio::fraction(-0.1);
    EXPECT_THAT(refusal(three, params), HasSubstr("from 0 to 1"));
}

TEST(OutlierRemovalRefusals, AllPointsTooFarFromEachOther_NothingWouldBeLeft) {
    EXPECT_EQ(refusal(three, by_radius(1, 0.5)),
              "3 of 3 points are outliers: no point has 1 other point within 0.5 u; nothing is left");
    EXPECT_THAT(refusal(on_a_line({4}), by_radius(1, 0.5)), HasSubstr("1 of 1 points are outliers"));
}

TEST(OutlierRemovalRefusals, AllPointsMarked_AreKept) {
    OutlierRemovalParams params = by_radius(1, 0.5);
    params.mark = true;
    Context context;
    const OutlierRemovalResult result = outlier_removal(three, params, context);
    EXPECT_EQ(result.points.size(), 3u);
    EXPECT_EQ(result.removed, 3u);
}

TEST(OutlierRemovalRefusals, NoComponentLargeEnough_NothingWouldBeLeft) {
    std::vector<Vec3> points = square_grid(10, 1);
    const std::vector<Vec3> others = square_grid(10, 1, Vec3(100, 0, 0));
    points.insert(points.end(), others.begin(), others.end());
    OutlierRemovalParams params;
    params.min_component = Ratio::percent(60);
    EXPECT_EQ(refusal(cloud_of_points(points), params),
              "200 of 200 points are outliers: the largest connected component has 100 of 200 positions, less than the "
              "min-component of 60 %; nothing is left");
}

/// No point is removed, with no warning, with `components` left.
void expect_all_kept(const PointCloud& cloud, std::size_t components) {
    Context context;
    const OutlierRemovalResult result = outlier_removal(cloud, {}, context);
    EXPECT_EQ(result.removed, 0u);
    EXPECT_EQ(result.points.size(), cloud.size());
    EXPECT_EQ(result.components, components);
    EXPECT_THAT(context.warnings(), IsEmpty());
}

TEST(OutlierRemovalUnusual, OnePoint_Stays) { expect_all_kept(on_a_line({7}), 1); }

TEST(OutlierRemovalUnusual, TwoPoints_Stay) { expect_all_kept(on_a_line({7, 8}), 1); }

TEST(OutlierRemovalUnusual, EqualPoints_Stay) { expect_all_kept(on_a_line({7, 7, 7, 7}), 1); }

TEST(OutlierRemovalUnusual, FewerPointsThanNeighbours_Stay) {
    expect_all_kept(on_a_line({0, 1, 2, 3, 4}), 1);
    expect_all_kept(vertices_of(cube()), 1);
    expect_all_kept(vertices_of(icosahedron()), 1);
}

TEST(OutlierRemovalUnusual, Line_Stays) {
    std::vector<Vec3> points;
    for (int i = 0; i < 1000; ++i) points.push_back(i * Vec3(1, 2, 3));
    expect_all_kept(cloud_of_points(points), 1);
}

TEST(OutlierRemovalUnusual, Plane_Stays) {
    expect_all_kept(cloud_of_points(square_grid(40, 0.1)), 1);
    expect_all_kept(flat_square(0), 1);
}

TEST(OutlierRemovalUnusual, TwoEqualClusters_BothStay) {
    for (const int side : {5, 40}) {
        std::vector<Vec3> points = square_grid(side, 1);
        const std::vector<Vec3> others = square_grid(side, 1, Vec3(1000, 0, 0));
        points.insert(points.end(), others.begin(), others.end());
        expect_all_kept(cloud_of_points(points), 2);
    }
}

TEST(OutlierRemovalUnusual, TwoScales_TheSparsePartStays) {
    // A part with a quarter of the points, five times as far apart, joined to the other part.
    std::vector<Vec3> points = square_grid(40, 1);
    const std::vector<Vec3> sparse = square_grid(20, 5, Vec3(41, 0, 0));
    points.insert(points.end(), sparse.begin(), sparse.end());
    expect_all_kept(cloud_of_points(points), 1);
    // One in a hundred of the points, 20 times as far apart, is flat and has most of the area.
    points = square_grid(100, 1);
    for (int i = 0; i < 100; ++i) points.emplace_back(120 + 20 * (i % 10), 20 * (i / 10), 0);
    expect_all_kept(cloud_of_points(points), 2);
}

}  // namespace
}  // namespace scanmill::test
