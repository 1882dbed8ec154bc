// SPDX-License-Identifier: GPL-3.0-or-later
/// Pairs on curved edges, whose planned tangents are wrong, and beside corners.

#include <gmock/gmock.h>

#include "filters/probe_compensate/cases.hpp"

namespace scanmill::test {
namespace {

using Tangent = ProbeCompensateParams::Tangent;
constexpr double r = 2;

/// Touches of a rim of radius R at `count` places, in planes that are turned about z by `error` radians, alternately to
/// either side. The two balls of a pair then touch the rim at different angles.
std::vector<Touch> on_rim(double R, int count, double error, double psi = 0.3) {
    std::vector<Touch> touches;
    for (int i = 0; i < count; ++i) {
        const double theta = 2 * std::numbers::pi * i / count, tilt = i % 2 ? error : -error;
        const Vec3 across(std::cos(theta + tilt), std::sin(theta + tilt), 0),
            edge(R * std::cos(theta), R * std::sin(theta), 0);
        for (const double side : {psi, -psi}) {
            // The centre is in the plane through the edge's point, at the distance r from the rim: at x across it and
            // at the height z, where the distance from the axis gives the contact.
            const double x = -r * std::sin(side);
            const double radial = std::hypot(edge.x() + x * across.x(), edge.y() + x * across.y()) - R;
            const Vec3 centre = edge + x * across + std::sqrt(r * r - radial * radial) * Vec3::UnitZ();
            const Vec3 u = (std::cos(side) * Vec3::UnitZ() - std::sin(side) * across).normalized();
            touches.push_back({centre - r * u, u, static_cast<double>(i), 0, 0.001});
        }
    }
    return touches;
}

double largest_deviation(const Compensated& result, double R) {
    double largest = 0;
    for (const Vec3& p : result.points.positions)
        largest = std::max(largest, std::hypot(std::hypot(p.x(), p.y()) - R, p.z()));
    return largest;
}

TEST(ProbeCompensateCurved, OnARim_WrongTangentsDoNotMatter) {
    for (const double R : {5., 21.})
        for (const double error : {0.0, 0.2, 0.4}) {
            const Compensated result = compensated(on_rim(R, 16, error), with_radius(r));
            EXPECT_EQ(result.curved, 16u);
            EXPECT_LT(largest_deviation(result, R), 1e-8) << R << " " << error;
            EXPECT_EQ(result.metrics.find("curved")->value, 16);
        }
}

TEST(ProbeCompensateCurved, TangentsOfApproaches_ErrOnARim) {
    ProbeCompensateParams params = with_radius(r);
    params.tangent = Tangent::approaches;
    const Compensated result = compensated(on_rim(5, 16, 0.4), params);
    EXPECT_EQ(result.curved, 0u);
    EXPECT_GT(largest_deviation(result, 5), 0.01);
    EXPECT_LT(largest_deviation(compensated(on_rim(5, 16, 0), params), 5), 1e-12) << "with the tangents of the rim";
}

TEST(ProbeCompensateCurved, LinesHaveTheCorrectedPoints) {
    const Compensated result = compensated(on_rim(5, 16, 0.4), with_radius(r));
    ASSERT_GE(result.features.positions.size(), 16u);
    for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(result.features.positions[i], result.points.positions[i]);
}

TEST(ProbeCompensateCurved, PointsBesideASingle_AndWithoutAFeature_StayAsTheyAre) {
    std::vector<Touch> touches = on_rim(5, 16, 0.4);
    touches.erase(touches.begin() + 21);  // one of the two of touch 10
    EXPECT_EQ(compensated(touches, with_radius(r)).curved, 11u);
    EXPECT_EQ(compensated(cloud_of(touches, Columns::without_feature), with_radius(r)).curved, 0u);
    touches.resize(8);
    EXPECT_EQ(compensated(touches, with_radius(r)).curved, 0u) << "an open line of four";
}

/// Pairs along a polygon in the plane z = 0; the faces are vertical and horizontal.
std::vector<Touch> along(const std::vector<Vec3>& points, const std::vector<Vec3>& tangents) {
    std::vector<Touch> touches;
    for (std::size_t i = 0; i < points.size(); ++i)
        for (const double phi : {0.3, -0.3}) {
            const Vec3 out = tangents[i].cross(Vec3::UnitZ());
            const Vec3 u = std::cos(phi) * Vec3::UnitZ() + std::sin(phi) * out;
            touches.push_back({points[i], u, static_cast<double>(i), 0, 0.001});
        }
    return touches;
}

TEST(ProbeCompensateCurved, PointsAtACorner_StayAsTheyAre) {
    // The touches nearest the corner are at any share of the distance.
    for (double first = 0.05; first < 1; first += 0.1) {
        std::vector<Vec3> points, tangents;
        for (int i = 4; i >= 0; --i) points.push_back({-2 * (i + first), 0, 0}), tangents.push_back(Vec3::UnitX());
        for (int i = 1; i <= 5; ++i) points.push_back({0, 2 * (i - first), 0}), tangents.push_back(Vec3::UnitY());
        const Compensated result = compensated(along(points, tangents), with_radius(r));
        ASSERT_EQ(result.features.polylines.size(), 1u) << "the corner is within the line";
        for (std::size_t i = 0; i < points.size(); ++i)
            EXPECT_LT((result.points.positions[i] - points[i]).norm(), 1e-9) << first << " " << i;
        EXPECT_GE(result.curved, 2u) << "on the straight sides";
    }
}

/// The deviation from the rim of radius 5 as a share of the uncertainty, root mean square over many noisy measurements.
double relative_deviation(int count, double error, double sigma) {
    Random random(6);
    double squares = 0, expected = 0;
    for (int trial = 0; trial * count < 3200; ++trial) {
        std::vector<Touch> touches = on_rim(5, count, error);
        for (Touch& touch : touches) {
            touch.uncertainty = sigma;
            for (double& coordinate : touch.position) coordinate += sigma * random.normal();
        }
        const Compensated result = compensated(touches, with_radius(r));
        for (std::size_t i = 0; i < result.points.size(); ++i) {
            const Vec3& p = result.points.positions[i];
            const double radial = std::hypot(p.x(), p.y()) - 5;
            squares += radial * radial + p.z() * p.z();
            expected += result.number("uncertainty", i) * result.number("uncertainty", i);
        }
    }
    return std::sqrt(squares / expected);
}

TEST(ProbeCompensateCurved, UncertaintyHolds_WithNoiseAndWrongTangents) {
    EXPECT_NEAR(relative_deviation(16, 0.3, 0.001), 1.03, 0.07) << "the noise of the neighbours adds little";
}

TEST(ProbeCompensateCurved, UncertaintyHolds_IfTouchesAreNearerThanTheNoise) {
    EXPECT_NEAR(relative_deviation(400, 0.1, 0.01), 1.03, 0.07) << "touches are 0.08 apart, their error is 0.025";
}

}  // namespace
}  // namespace scanmill::test
