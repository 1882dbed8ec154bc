// SPDX-License-Identifier: GPL-3.0-or-later
/// Cases of outlier-removal that can be computed by hand.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "filters/outlier_removal/cases.hpp"
#include "support/doubts.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Method = OutlierRemovalParams::Method;

TEST(OutlierRemoval, FivePointsOnALine_TheLimitIsMeanPlusFactorTimesSampleDeviation) {
    // Distances to the nearest: 1, 1, 1, 1, 7; their mean is 11/5, the sum of squared deviations 28.8.
    const OutlierRemovalResult result = clean(on_a_line({0, 1, 2, 3, 10}), suspects_only(1, 1));
    EXPECT_NEAR(result.limit, 2.2 + std::sqrt(28.8 / 4), 1e-9);
    EXPECT_THAT(result.kept, ElementsAre(0, 1, 2, 3));
    EXPECT_EQ(result.removed, 1u);
    EXPECT_EQ(result.suspects, 1u);
}

TEST(OutlierRemoval, TwoNeighbours_TheirDistancesAreAveraged) {
    const OutlierRemovalResult result = clean(on_a_line({0, 1, 2, 4.5, 9}), suspects_only(2, 1.5));
    const double first = 1.5, second = 1, third = 1.5, fourth = 3, fifth = 5.75;  // (4.5 + 7) / 2
    const double mean = (first + second + third + fourth + fifth) / 5;
    double squares = 0;
    for (const double distance : {first, second, third, fourth, fifth})
        squares += (distance - mean) * (distance - mean);
    EXPECT_NEAR(result.limit, mean + 1.5 * std::sqrt(squares / 4), 1e-9);
    EXPECT_THAT(result.kept, ElementsAre(0, 1, 2, 3));
}

TEST(OutlierRemoval, EqualDistances_AllPointsAreAtTheLimitAndPass) {
    EXPECT_EQ(clean(cloud_of_points(square_grid(2, 0.1)), suspects_only(2, 1e-3)).removed, 0u);
    // A circle: distances that differ by rounding alone make no suspects.
    std::vector<Vec3> circle;
    for (int i = 0; i < 100; ++i) circle.emplace_back(std::cos(i * 0.02 * M_PI), std::sin(i * 0.02 * M_PI), 0);
    EXPECT_EQ(clean(cloud_of_points(circle), suspects_only(4, 0.1)).suspects, 0u);
}

TEST(OutlierRemoval, Duplicates_AreNeighboursAtDistanceZeroAndThePointItselfIsNone) {
    // With one neighbour the distances are 0, 0, 1 and 2.
    const OutlierRemovalResult result = clean(on_a_line({0, 0, 1, 3}), suspects_only(1, 1));
    EXPECT_NEAR(result.limit, 0.75 + std::sqrt((2 * 0.5625 + 0.0625 + 1.5625) / 3), 1e-9);
    EXPECT_THAT(result.kept, ElementsAre(0, 1, 2));
    // With two neighbours the point at 1 has both duplicates at distance 1.
    EXPECT_NEAR(clean(on_a_line({0, 0, 1, 3}), suspects_only(2, 1e-9)).limit, (0.5 + 0.5 + 1 + 2.5) / 4, 1e-6);
}

TEST(OutlierRemoval, Radius_PointsWithFewerOthersWithinItAreSuspects) {
    EXPECT_THAT(clean(on_a_line({0, 1, 2, 5}), by_radius(1, 1)).kept, ElementsAre(0, 1, 2));
    EXPECT_THAT(clean(on_a_line({0, 1, 2, 5}), by_radius(2, 1)).kept, ElementsAre(1));
    EXPECT_THAT(clean(on_a_line({0, 0, 0, 5}), by_radius(2, 1)).kept, ElementsAre(0, 1, 2));
}

TEST(OutlierRemoval, DistanceEqualToTheRadius_IsWithinIt) {
    EXPECT_EQ(clean(on_a_line({0, 1}), by_radius(1, 1)).removed, 0u);
    EXPECT_EQ(clean(on_a_line({0, 1, 2, 2.5}), by_radius(1, 0.5)).kept.size(), 2u);
}

TEST(OutlierRemoval, SuspectThatIsConnectedToTheScan_IsKept) {
    // The last of twenty points is a suspect, but among the nearest of its nearest, and at most twice the limit away.
    std::vector<Vec3> points;
    for (int i = 0; i < 20; ++i) points.emplace_back(i, 0, 0);
    points.emplace_back(21.5, 0, 0);
    OutlierRemovalParams params = suspects_only(4, 2);
    EXPECT_EQ(clean(cloud_of_points(points), params).kept.size(), 20u);
    params.min_component = Ratio::percent(0.1);
    const OutlierRemovalResult result = clean(cloud_of_points(points), params);
    EXPECT_EQ(result.removed, 0u);
    EXPECT_GT(result.suspects, 0u);
    EXPECT_EQ(result.components, 1u);
}

TEST(OutlierRemoval, GroupNoLargerThanTheNeighbours_IsRemovedAndALargerOneStays) {
    OutlierRemovalParams params;
    params.neighbours = 4;
    const auto with_group = [](int size) {
        std::vector<Vec3> points = square_grid(20, 1);
        for (int i = 0; i < size; ++i) points.emplace_back(100 + i, 0, 0);
        return cloud_of_points(points);
    };
    EXPECT_EQ(clean(with_group(4), params).removed, 4u);
    EXPECT_EQ(clean(with_group(5), params).removed, 0u);
    EXPECT_EQ(clean(with_group(5), params).components, 2u);
}

TEST(OutlierRemoval, ComponentSmallerThanTheShare_IsRemovedAndAnEqualOneStays) {
    std::vector<Vec3> points = square_grid(5, 1, Vec3(100, 0, 0));
    for (int i = 0; i < 75; ++i) points.emplace_back(i % 15, i / 15, 0);
    OutlierRemovalParams params;
    params.neighbours = 4;
    params.min_component = Ratio::percent(25);
    EXPECT_EQ(clean(cloud_of_points(points), params).removed, 0u);
    params.min_component = Ratio::percent(35);  // points at a border stand for more area
    EXPECT_EQ(clean(cloud_of_points(points), params).removed, 25u);
}

TEST(OutlierRemoval, DenseGroupWithinTheRadius_BelongsToTheScan) {
    // The nearest points of each group are its own, so only the radius connects them.
    std::vector<Vec3> points = square_grid(30, 1);
    const std::vector<Vec3> group = square_grid(5, 0.1, Vec3(31, 10, 0));
    points.insert(points.end(), group.begin(), group.end());
    OutlierRemovalParams params;
    params.neighbours = 4;
    params.min_component = Ratio::percent(10);
    params.radius = 1.5;
    EXPECT_EQ(clean(cloud_of_points(points), params).removed, 25u);
    params.radius = 2;  // the distance
    EXPECT_EQ(clean(cloud_of_points(points), params).removed, 0u);
    EXPECT_EQ(clean(cloud_of_points(points), params).components, 1u);
}

TEST(OutlierRemoval, PointAboveAPlane_Hovers) {
    // At 2 spacings it is near enough to be connected, but its neighbours lie in a plane below it.
    std::vector<Vec3> points = square_grid(30, 1);
    points.emplace_back(15, 15, 2);
    const OutlierRemovalResult result = clean(cloud_of_points(points));
    EXPECT_EQ(result.hovering, 1u);
    EXPECT_EQ(result.removed, 1u);
    EXPECT_EQ(result.kept.back(), 899u);
    // A point of the plane as far from all others is a part of the surface.
    points.back() = Vec3(31, 15, 0);
    EXPECT_EQ(clean(cloud_of_points(points)).removed, 0u);
}

TEST(OutlierRemoval, LonePointInAFlatRegion_IsAPartOfTheSurface) {
    // A square with a single point in its empty middle, like the vertices of a CAD model: no point has it as a
    // neighbour, but it lies in the plane.
    std::vector<Vec3> points;
    for (const Vec3& p : square_grid(41, 1))
        if ((p - Vec3(20, 20, 0)).cwiseAbs().maxCoeff() > 2.5) points.push_back(p);
    points.emplace_back(20, 20, 0);
    const OutlierRemovalResult flat = clean(cloud_of_points(points));
    EXPECT_GT(flat.suspects, 0u);
    EXPECT_EQ(flat.removed, 0u);
    points.back().z() = 2;
    EXPECT_EQ(clean(cloud_of_points(points)).removed, 1u);
}

TEST(OutlierRemoval, ManyPointsAtOneDistantPosition_AreOnePosition) {
    // Scanners write (0, 0, 0) where they saw nothing.
    std::vector<Vec3> points = square_grid(30, 1, Vec3(100, 100, 0));
    points.resize(1000, Vec3::Zero());
    const OutlierRemovalResult result = clean(cloud_of_points(points));
    EXPECT_EQ(result.removed, 100u);
    EXPECT_EQ(result.kept.size(), 900u);
}

TEST(OutlierRemoval, Columns_AreCarriedAndRowsStayInOrder) {
    PointCloud cloud = on_a_line({10, 3, 2, 1, 0});
    cloud.columns.add(Column("number", 1, Buffer<u32>{50, 40, 30, 20, 10}));
    const OutlierRemovalResult result = clean(cloud, suspects_only(1, 1));
    EXPECT_THAT(result.points.columns.find("number")->values<u32>(), ElementsAre(40, 30, 20, 10));
    EXPECT_EQ(result.points.positions[0], Vec3(3, 0, 0));
    EXPECT_EQ(result.points.positions[3], Vec3(0, 0, 0));
}

TEST(OutlierRemoval, Mark_KeepsAllPointsAndMarksThoseThatWouldBeRemoved) {
    PointCloud cloud = on_a_line({0, 1, 10, 2, 3});
    cloud.columns.add(Column("outlier", 1, Buffer<double>{5, 5, 5, 5, 5}));
    cloud.columns.add(Column("number", 1, Buffer<u32>{1, 2, 3, 4, 5}));
    OutlierRemovalParams params = suspects_only(1, 1);
    params.mark = true;
    Context context;
    const OutlierRemovalResult result = outlier_removal(cloud, params, context);
    EXPECT_EQ(result.points.size(), 5u);
    EXPECT_THAT(result.points.columns.find("outlier")->values<u8>(), ElementsAre(0, 0, 1, 0, 0));
    EXPECT_EQ(result.points.columns.size(), 2u);
    EXPECT_THAT(result.kept, ElementsAre(0, 1, 3, 4));
    EXPECT_EQ(result.removed, 1u);
    EXPECT_THAT(context.warnings(), testing::Contains(HasSubstr("'outlier' of the input is replaced")));
}

TEST(OutlierRemoval, Metrics_AreThoseOfTheResult) {
    Context context;
    const OutlierRemovalResult result = outlier_removal(with_outliers(random_sphere(2000, 1), 50, 2, 7), {}, context);
    const auto metric = [&](std::string_view name) { return context.metrics().find(name)->value; };
    EXPECT_EQ(metric("kept"), static_cast<double>(result.kept.size()));
    EXPECT_EQ(metric("removed"), static_cast<double>(result.removed));
    EXPECT_EQ(metric("suspects"), static_cast<double>(result.suspects));
    EXPECT_EQ(metric("hovering"), static_cast<double>(result.hovering));
    EXPECT_EQ(metric("components"), 1);
    EXPECT_EQ(metric("log-limit"), result.log_limit);
    EXPECT_EQ(metric("scattered"), static_cast<double>(result.scattered));
    EXPECT_THAT(sentences_of(context), IsEmpty());
}

TEST(OutlierRemoval, MoreThanATenthRemoved_IsReported) {
    // Twenty points, each far from all others.
    std::vector<Vec3> points = square_grid(10, 1);
    for (int i = 1; i <= 20; ++i) points.emplace_back(0, 0, 1000 * i);
    Context context;
    EXPECT_EQ(outlier_removal(cloud_of_points(points), by_radius(4, 2, Ratio::percent(0.1)), context).removed, 20u);
    EXPECT_THAT(doubts_of(context), ElementsAre(HasSubstr("20 of 120 points are outliers (17 %)")));
}

TEST(OutlierRemoval, Cancelled_Ends) {
    ContextOptions options;
    options.is_cancelled = [] { return true; };
    Context context(options);
    EXPECT_THROW(outlier_removal(random_sphere(1000, 1), {}, context), Cancelled);
}

TEST(OutlierRemoval, Progress_RisesToOne) {
    ContextOptions options;
    std::vector<double> fractions;
    options.on_progress = [&](double fraction) { fractions.push_back(fraction); };
    Context context(options);
    outlier_removal(random_sphere(20'000, 1), {}, context);
    EXPECT_GT(fractions.size(), 4u);
    EXPECT_TRUE(std::ranges::is_sorted(fractions));
    EXPECT_EQ(fractions.back(), 1);
}

}  // namespace
}  // namespace scanmill::test
