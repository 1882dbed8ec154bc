// SPDX-License-Identifier: GPL-3.0-or-later
/// Lines that follow circles between touches.

#include "probe_compensate/arcs.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "filters/probe_compensate/cases.hpp"

namespace scanmill::test {
namespace {

using compensating::along_arcs;

FeatureGraph line_through(const Array<Vec3>& points, bool closed = false) {
    FeatureGraph graph;
    const u32 count = static_cast<u32>(points.size());
    graph.positions = Array<Vec3>(points);
    Array<u32> vertices(count);
    std::iota(vertices.begin(), vertices.end(), 0u);
    graph.vertices = std::move(vertices);
    graph.left_normals = graph.right_normals = Buffer<Vec3>(Array<Vec3>(count, Vec3::Zero()));
    graph.polylines = {{FeatureType::crease, closed, 0, count}};
    return graph;
}

/// Points of a circle of radius R in a tilted plane.
Array<Vec3> on_circle(double R, int count, double whole) {
    const Vec3 x = Vec3(1, 2, 2) / 3, y = Vec3(2, 1, -2) / 3;
    Array<Vec3> points;
    for (int i = 0; i < count; ++i) {
        const double theta = whole * i / count;
        points.push_back(Vec3(7, 8, 9) + R * (std::cos(theta) * x + std::sin(theta) * y));
    }
    return points;
}

FeatureGraph refined(const Array<Vec3>& points, bool closed, double chord_error) {
    return along_arcs(line_through(points, closed), std::vector<bool>(points.size(), true), chord_error);
}

TEST(ProbeCompensateArcs, ACircle_IsExact_AndItsChordsAreWithinTheError) {
    constexpr double R = 5, error = 0.01;
    const FeatureGraph line = refined(on_circle(R, 16, 2 * std::numbers::pi), true, error);
    ASSERT_EQ(line.polylines.size(), 1u);
    EXPECT_TRUE(line.polylines[0].closed);
    // A sagitta of R (1 - cos(pi / 16)) = 0.0961: four parts, of 1/16 of it.
    ASSERT_EQ(line.vertices.size(), 64u);
    for (u32 i = 0; i < 64; ++i) {
        const Vec3& here = line.positions[line.vertices[i]];
        const Vec3& next = line.positions[line.vertices[(i + 1) % 64]];
        EXPECT_NEAR((here - Vec3(7, 8, 9)).norm(), R, 1e-12);
        EXPECT_LT(R - ((here + next) / 2 - Vec3(7, 8, 9)).norm(), error);
    }
}

TEST(ProbeCompensateArcs, TheEndsOfAnOpenArc_FollowTheCircleOfTheirOnlyNeighbours) {
    const FeatureGraph line = refined(on_circle(5, 5, 1.5), false, 0.001);
    EXPECT_GT(line.vertices.size(), 9u);
    for (const Vec3& p : line.positions) EXPECT_NEAR((p - Vec3(7, 8, 9)).norm(), 5, 1e-12);
    EXPECT_EQ(line.vertices[0], 0u);
    EXPECT_EQ(line.vertices[line.vertices.size() - 1], 4u);
}

TEST(ProbeCompensateArcs, StraightLines_CornersAndTwoPoints_StayAsTheyAre) {
    EXPECT_EQ(refined({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3.5, 0, 0}}, false, 1e-9).vertices.size(), 4u);
    EXPECT_EQ(refined({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, true, 1e-9).vertices.size(), 4u) << "a square";
    EXPECT_EQ(refined({{0, 0, 0}, {1, 0, 0}}, false, 1e-9).vertices.size(), 2u);
    EXPECT_EQ(refined({{0, 0, 0}, {9, 0, 0}, {10, 0.5, 0}}, false, 1e-9).vertices.size(), 3u)
        << "distances of 9 and 1 tell no circle";
}

TEST(ProbeCompensateArcs, BesideAPointThatIsNotExact_TheOtherCircleCounts) {
    Array<Vec3> points = on_circle(5, 8, 2);
    points[3] += Vec3(0.3, 0.2, -0.1);
    std::vector<bool> is_exact(8, true);
    is_exact[3] = false;
    const FeatureGraph line = along_arcs(line_through(points), is_exact, 0.001);
    for (u32 i = 0; i < line.positions.size(); ++i)
        if (i != 3) {
            EXPECT_NEAR((line.positions[i] - Vec3(7, 8, 9)).norm(), 5, 1e-12);
        }
    const auto place = [&](u32 vertex) { return std::ranges::find(line.vertices, vertex) - line.vertices.begin(); };
    EXPECT_EQ(place(3), place(2) + 1) << "straight on both of its sides";
    EXPECT_EQ(place(4), place(3) + 1);
    EXPECT_GT(place(2), place(1) + 1);
}

TEST(ProbeCompensateArcs, LinesOfPairs_FollowARim_AndChordErrorIsAParameter) {
    std::vector<Touch> touches;
    for (int i = 0; i < 16; ++i) {
        const double theta = 2 * std::numbers::pi * i / 16;
        const Eigen::AngleAxisd turn(theta, Vec3::UnitZ());
        for (const double phi : {0.3, -0.3}) {
            Touch touch = touch_of({0, 0, 0}, phi, 0, 2, i);
            touch.position = turn * (touch.position + Vec3(5, 0, 0));
            touch.approach = turn * touch.approach;
            touches.push_back(touch);
        }
    }
    ProbeCompensateParams params = with_radius(2);
    EXPECT_EQ(compensated(touches, params).features.vertices.size(), 64u) << "0.5 % of 1.95: 0.0098";
    params.chord_error = Length(0.1);
    EXPECT_EQ(compensated(touches, params).features.vertices.size(), 16u);
    params.chord_error = Length(0.0);
    EXPECT_THROW(compensated(touches, params), Error);
    for (std::size_t i = touches.size(); i-- > 0;)
        if (i % 2) touches.erase(touches.begin() + static_cast<std::ptrdiff_t>(i));
    params.chord_error.reset();
    EXPECT_EQ(compensated(touches, params).features.vertices.size(), 16u) << "singles are joined by straight chords";
}

TEST(ProbeCompensateArcs, Noise_IsTheUncertaintyOfTouchesWithoutTheColumn) {
    const PointCloud all = cloud_of({touch_of({0, 0, 0}, 0.5, 0, 2), touch_of({0, 0, 0}, -0.5, 0, 2)});
    PointCloud cloud;
    cloud.positions = all.positions;
    for (const char* name : {"approach", "touch"}) cloud.columns.add(*all.columns.find(name));
    ProbeCompensateParams params = with_radius(2);
    params.noise = Length(0.003);
    const Compensated result = compensated(cloud, params);
    ASSERT_EQ(result.points.size(), 1u);
    EXPECT_NEAR(result.points.columns.find("uncertainty")->number(0), 0.003 * std::sqrt(2) / std::sin(1.0), 1e-12);
    params.noise = Length(-1.0);
    EXPECT_THROW(compensated(cloud, params), Error);
}

}  // namespace
}  // namespace scanmill::test
