// SPDX-License-Identifier: GPL-3.0-or-later
/// Lines through touched points: which touches are joined.

#include <gmock/gmock.h>

#include "filters/probe_compensate/cases.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;

/// Single touches along y, exact.
std::vector<Touch> along_y(const std::vector<double>& places, double feature = 0) {
    std::vector<Touch> touches;
    for (const double y : places)
        touches.push_back(touch_of({0, y, 0}, 0, 0, 1, 1000 * feature + static_cast<double>(touches.size()), feature));
    return touches;
}

/// Touches on a circle round z, at these angles in degrees.
std::vector<Touch> on_circle(const std::vector<double>& angles) {
    std::vector<Touch> touches;
    for (const double angle : angles)
        touches.push_back(touch_of({10 * std::cos(angle * degree), 10 * std::sin(angle * degree), 0}, 0, 0, 1,
                                   static_cast<double>(touches.size())));
    return touches;
}

/// The y coordinates of each line's points; a closed line ends with its first point.
std::vector<std::vector<double>> lines_of(const FeatureGraph& graph) {
    std::vector<std::vector<double>> lines;
    for (const FeaturePolyline& line : graph.polylines) {
        lines.emplace_back();
        EXPECT_EQ(line.type, FeatureType::crease);
        for (u32 i = line.begin; i < line.end; ++i) lines.back().push_back(graph.positions[graph.vertices[i]].y());
        if (line.closed) lines.back().push_back(lines.back().front());
    }
    return lines;
}

using Places = std::vector<double>;

TEST(ProbeCompensateLines, TouchesOfAFeature_AreJoinedInTheirOrder_AGapEndsTheLine) {
    const Compensated result = compensated(along_y({0, 1, 2, 3.9, 6, 7}), with_radius(1));
    EXPECT_THAT(lines_of(result.features), ElementsAre(Places{0, 1, 2, 3.9}, Places{6, 7}));
    EXPECT_EQ(result.metrics.find("lines")->value, 2);
    EXPECT_EQ(result.lone, 0u);
    for (const auto* normals : {&result.features.left_normals, &result.features.right_normals}) {
        ASSERT_EQ(normals->size(), 6u);
        for (const Vec3& n : *normals) EXPECT_EQ(n, Vec3(Vec3::Zero()));
    }
    EXPECT_TRUE(result.features.corners.empty());
}

TEST(ProbeCompensateLines, ExactlyTwoSpacings_AreAGap) {
    EXPECT_THAT(lines_of(compensated(along_y({0, 1, 2, 4, 5}), with_radius(1)).features),
                ElementsAre(Places{0, 1, 2}, Places{4, 5}));
}

TEST(ProbeCompensateLines, AGivenSpacing_Decides) {
    ProbeCompensateParams params = with_radius(1);
    params.spacing = 3;
    EXPECT_THAT(lines_of(compensated(along_y({0, 1, 2, 7.9, 14}), params).features), ElementsAre(Places{0, 1, 2, 7.9}));
    EXPECT_EQ(compensated(along_y({0, 1, 2, 7.9, 14}), params).lone, 1u);
}

TEST(ProbeCompensateLines, FeaturesThatAlternate_KeepTheirOwnLinesAndSpacings) {
    const std::vector<Touch> a = along_y({0, 1, 2}, 8), b = along_y({100, 130, 160}, 3);
    const Compensated result = compensated({b[0], a[0], a[1], b[1], b[2], a[2]}, with_radius(1));
    EXPECT_THAT(lines_of(result.features), ElementsAre(Places{100, 130, 160}, Places{0, 1, 2}));
}

TEST(ProbeCompensateLines, PairsAndSingles_ShareALine_AndARepeatedSingleCountsOnce) {
    std::vector<Touch> touches = along_y({0, 1, 2});
    touches.push_back(touch_of({0, 3, 0}, 0.3, 0, 1, 3));
    touches.push_back(touch_of({0, 3, 0}, -0.3, 0, 1, 3));
    touches.push_back(touch_of({0, 2.01, 0}, 0.01, 0, 1, 2));  // touch 2 again
    const Compensated result = compensated(touches, with_radius(1));
    EXPECT_EQ(result.points.size(), 5u);
    ASSERT_EQ(result.features.polylines.size(), 1u);
    EXPECT_EQ(result.features.positions.size(), 4u);
    EXPECT_LT((result.features.positions[3] - Vec3(0, 3, 0)).norm(), 1e-12);
}

TEST(ProbeCompensateLines, TouchesRoundARim_CloseTheLine) {
    const Compensated rim = compensated(on_circle({0, 45, 90, 135, 180, 225, 270, 315}), with_radius(1));
    ASSERT_EQ(rim.features.polylines.size(), 1u);
    EXPECT_TRUE(rim.features.polylines[0].closed);
    EXPECT_EQ(rim.features.positions.size(), 8u);
    EXPECT_TRUE(compensated(on_circle({0, 120, 240}), with_radius(1)).features.polylines[0].closed);
    EXPECT_FALSE(compensated(on_circle({0, 45, 90, 135, 180, 225, 270}), with_radius(1)).features.polylines[0].closed);
}

TEST(ProbeCompensateLines, ThreeTouchesOfAStraightLine_StayOpen) {
    EXPECT_FALSE(compensated(along_y({0, 1, 1.99}), with_radius(1)).features.polylines[0].closed);
    EXPECT_FALSE(compensated(along_y({0, 1}), with_radius(1)).features.polylines[0].closed);
}

TEST(ProbeCompensateLines, ARimWithOneGap_IsOneOpenLine) {
    const Compensated rim = compensated(on_circle({0, 30, 60, 90, 180, 210, 240, 270, 300, 330}), with_radius(1));
    ASSERT_EQ(rim.features.polylines.size(), 1u);
    EXPECT_FALSE(rim.features.polylines[0].closed);
    EXPECT_NEAR(rim.features.positions[0].x(), -10, 1e-12) << "begins behind the gap";
    EXPECT_NEAR(rim.features.positions[9].y(), 10, 1e-12);
}

TEST(ProbeCompensateLines, ATouchAtThePositionOfItsPredecessor_IsLeftOut) {
    EXPECT_THAT(lines_of(compensated(along_y({0, 1, 1, 2}), with_radius(1)).features), ElementsAre(Places{0, 1, 2}));
    const Compensated one = compensated(along_y({1, 1, 1}), with_radius(1));
    EXPECT_TRUE(one.features.polylines.empty());
    EXPECT_EQ(one.lone, 1u);
}

TEST(ProbeCompensateLines, TouchesOfOnePlace_CountOnce_AndAPairStandsForSingles) {
    std::vector<Touch> touches = along_y({0, 1, 2});
    touches.push_back(touch_of({0, 2.1, 0}, 0.3, 0, 1, 3));
    touches.push_back(touch_of({0, 2.1, 0}, -0.3, 0, 1, 3));
    touches.push_back(touch_of({0, 3, 0}, 0, 0, 1, 4));
    const Compensated result = compensated(touches, with_radius(1));
    ASSERT_EQ(result.features.positions.size(), 4u);
    EXPECT_NEAR(result.features.positions[2].y(), 2.1, 1e-12) << "the pair, not the single touch before it";
    EXPECT_EQ(result.metrics.find("repeated")->value, 1);
}

TEST(ProbeCompensateLines, AGivenSpacingFarAboveTheTouches_LeavesNoneOut) {
    ProbeCompensateParams params = with_radius(1);
    params.spacing = 10;
    const Compensated result = compensated(along_y({0, 1, 2, 3}), params);
    EXPECT_EQ(result.features.positions.size(), 4u);
    EXPECT_EQ(result.metrics.find("repeated")->value, 0);
}

TEST(ProbeCompensateLines, WithoutTheColumnFeature_ThereAreNone) {
    const Compensated result = compensated(cloud_of(along_y({0, 1, 2}), Columns::without_feature), with_radius(1));
    EXPECT_TRUE(result.features.polylines.empty());
    EXPECT_EQ(result.lone, 0u);
}

TEST(ProbeCompensateLines, APlanNamesTheLines_WhereTheTouchesHaveNumbersAlone) {
    std::vector<Touch> touches;
    for (int i = 0; i < 6; ++i) touches.push_back(touch_of(Vec3(0, i, 0), 0.3, 0, 2, 10 + i));
    ProbePlan plan;
    for (u32 i = 0; i < 6; ++i) {
        plan.touches.emplace_back();
        plan.touches.back().touch = 10 + i;
        plan.touches.back().feature = i < 3 ? 4 : 7;
    }
    const PointCloud named = with_features(cloud_of(touches, Columns::without_feature), plan);
    const std::span<const u32> features = named.columns.find("feature")->values<u32>();
    EXPECT_THAT(std::vector<u32>(features.begin(), features.end()), testing::ElementsAre(4, 4, 4, 7, 7, 7));
    EXPECT_EQ(compensated(named, with_radius(2)).features.polylines.size(), 2u);
    // A column of the touches' own counts.
    EXPECT_EQ(with_features(cloud_of(touches), plan).columns.find("feature")->number(0), 0);
    plan.touches.pop_back();
    const Error unknown = error_of([&] { with_features(cloud_of(touches, Columns::without_feature), plan); });
    EXPECT_EQ(unknown.sentence(), "row 5 is of touch 15, which is not in the plan of 5 touches");
    EXPECT_FALSE(unknown.hint().empty());
    EXPECT_THAT(error_of([&] { with_features(cloud_of(touches, Columns::approach_only), plan); }).sentence(),
                testing::HasSubstr("no column 'touch'"));
}

TEST(ProbeCompensateLines, TouchesOfOnePoint_AlsoInTheWrongOrder_CountOnce) {
    EXPECT_THAT(lines_of(compensated(along_y({0, 2, 4.4, 4.2, 6, 8}), with_radius(1)).features),
                ElementsAre(ElementsAre(0, 2, 4.4, 6, 8)));
    EXPECT_THAT(lines_of(compensated(along_y({0, 2, 4, 4.5, 6, 8}), with_radius(1)).features),
                ElementsAre(ElementsAre(0, 2, 4, 4.5, 6, 8)))
        << "exactly a quarter of the spacing";
    const FeatureGraph ring =
        compensated(on_circle({0, 45, 90, 135, 180, 225, 270, 315, 355}), with_radius(1)).features;
    ASSERT_EQ(ring.polylines.size(), 1u);
    EXPECT_TRUE(ring.polylines[0].closed);
    EXPECT_EQ(ring.polylines[0].end, 8u) << "the last touch is beside the first";
}

}  // namespace
}  // namespace scanmill::test
