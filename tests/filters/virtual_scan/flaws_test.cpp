// SPDX-License-Identifier: GPL-3.0-or-later
/// Noise, outliers, overlap and views of virtual scans.
#include <gmock/gmock.h>

#include <Eigen/LU>

#include <cmath>
#include <limits>

#include "filters/virtual_scan/cases.hpp"
#include "support/shapes.hpp"
#include "virtual_scan/view.hpp"

namespace scanmill::test {
namespace {

bool same_bytes(const VirtualScanResult& a, const VirtualScanResult& b) {
    return std::ranges::equal(a.points.positions, b.points.positions) && a.points.columns == b.points.columns;
}

TEST(VirtualScanNoise, AlongTheRay_HasTheGivenDeviation) {
    VirtualScanParams params = sphere(0.01);
    const VirtualScanResult exact = scan(params);
    params.noise = 0.002;
    const VirtualScanResult noisy = scan(params, 3);
    ASSERT_EQ(noisy.points.size(), exact.points.size());
    const auto views = noisy.points.columns.find("view")->values<std::int32_t>();
    const double count = static_cast<double>(noisy.points.size());
    double sum = 0, squares = 0, fourth = 0;
    for (std::size_t i = 0; i < noisy.points.size(); ++i) {
        const Vec3 error = noisy.points.positions[i] - exact.points.positions[i];
        const double along = error.dot(noisy.directions[static_cast<std::size_t>(views[i])]);
        ASSERT_NEAR(error.norm(), std::abs(along), 1e-12);
        const double scaled = along / 0.002;
        sum += scaled;
        squares += scaled * scaled;
        fourth += scaled * scaled * scaled * scaled;
    }
    ASSERT_GT(count, 1e5);
    // Five standard errors each, of a standard normal's first, second and fourth moment.
    EXPECT_NEAR(sum / count, 0, 5 / std::sqrt(count));
    EXPECT_NEAR(squares / count, 1, 5 * std::sqrt(2 / count));
    EXPECT_NEAR(fourth / count, 3, 5 * std::sqrt(96 / count));
}

TEST(VirtualScanNoise, SameSeed_SameBytes_AnotherSeedOthers) {
    VirtualScanParams params = sphere(0.05);
    params.noise = 0.01;
    params.outliers = Ratio::percent(5);
    params.overlap = Ratio::percent(50);
    EXPECT_TRUE(same_bytes(scan(params, 7), scan(params, 7)));
    EXPECT_TRUE(same_bytes(scan(params, 7), scan(params, 7, 2))) << "threads";
    EXPECT_FALSE(same_bytes(scan(params, 7), scan(params, 8)));
}

TEST(VirtualScanNoise, Outliers_DoNotChangeTheSurfacePoints) {
    VirtualScanParams params = sphere(0.05);
    params.noise = 0.01;
    const VirtualScanResult without = scan(params, 1);
    params.outliers = Ratio::percent(10);
    const VirtualScanResult with = scan(params, 1);
    for (std::size_t i = 0; i < without.points.size(); ++i)
        ASSERT_EQ(with.points.positions[i], without.points.positions[i]);
}

TEST(VirtualScanOutliers, ExactlyTheShare_AtTheEndInTheGrownBox) {
    VirtualScanParams params = sphere(0.02);
    params.outliers = Ratio::percent(7);
    const VirtualScanResult result = scan(params, 5);
    const std::size_t surface = result.points.size() - result.outliers;
    EXPECT_EQ(result.outliers, static_cast<std::size_t>(std::lround(0.07 * static_cast<double>(surface))));
    const auto views = result.points.columns.find("view")->values<std::int32_t>();
    BoundingBox box;
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        ASSERT_EQ(views[i] == -1, i >= surface);
        if (i < surface) continue;
        box.low = box.low.cwiseMin(result.points.positions[i]);
        box.high = box.high.cwiseMax(result.points.positions[i]);
    }
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(box.low[axis], -1.2);
        EXPECT_LT(box.low[axis], -1.19);
        EXPECT_LE(box.high[axis], 1.2);
        EXPECT_GT(box.high[axis], 1.19);
    }
}

/// The least distance between points of different views, and the number of points with a point of an earlier view
/// nearer than r.
std::pair<double, std::size_t> between_views(const VirtualScanResult& result, double r) {
    const auto views = result.points.columns.find("view")->values<std::int32_t>();
    double least = std::numeric_limits<double>::infinity();
    std::size_t near = 0;
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        bool is_near = false;
        for (std::size_t j = 0; j < result.points.size(); ++j) {
            if (views[i] == views[j]) continue;
            const double distance = (result.points.positions[i] - result.points.positions[j]).norm();
            least = std::min(least, distance);
            is_near |= distance < r && views[j] < views[i];
        }
        near += is_near;
    }
    return {least, near};
}

TEST(VirtualScanOverlap, None_LeavesNoTwoViewsNearerThanTheResolution) {
    VirtualScanParams params = sphere(0.08);
    const VirtualScanResult whole = scan(params);
    params.overlap = Ratio::percent(0);
    const VirtualScanResult result = scan(params);
    EXPECT_GE(between_views(result, 0.08).first, 0.08);
    EXPECT_EQ(result.points.size() + result.dropped, whole.points.size());
    EXPECT_GT(result.dropped, whole.points.size() / 2) << "twelve views see a sphere three times over";
    // No part of the surface is lost: every dropped point has a kept one nearby.
    for (const Vec3& p : whole.points.positions) {
        double least = 9;
        for (const Vec3& q : result.points.positions) least = std::min(least, (p - q).norm());
        ASSERT_LT(least, 0.08);
    }
}

TEST(VirtualScanOverlap, Half_KeepsAboutHalfOfWhatWasSeenBefore) {
    VirtualScanParams params = sphere(0.01);
    params.views = {0, 0, 1, 0, 0, 2};
    const std::size_t one_view = scan(params).points.size() / 2;
    params.overlap = Ratio::percent(50);
    const VirtualScanResult result = scan(params, 2);
    const double trials = static_cast<double>(one_view);
    EXPECT_NEAR(static_cast<double>(result.dropped), trials / 2, 5 * std::sqrt(trials) / 2);
}

TEST(VirtualScanViews, FibonacciSphere_IsEvenAndBalanced) {
    const double number[] = {200};
    const std::vector<Vec3> directions = scan::view_directions(number);
    ASSERT_EQ(directions.size(), 200u);
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < directions.size(); ++i) {
        EXPECT_NEAR(directions[i].norm(), 1, 1e-15);
        sum += directions[i];
        double nearest = 9;
        for (std::size_t j = 0; j < directions.size(); ++j)
            if (j != i) nearest = std::min(nearest, (directions[i] - directions[j]).norm());
        // A hexagonal packing of 200 would have 0.269; no neighbour much nearer, none missing.
        EXPECT_GT(nearest, 0.17);
        EXPECT_LT(nearest, 0.27);
    }
    EXPECT_LT(sum.norm() / 200, 0.01);
}

TEST(VirtualScanViews, GivenDirections_AreNormalised) {
    const double numbers[] = {0, 0, 5, 3, -4, 0, 1e-200, 0, 0};
    EXPECT_THAT(scan::view_directions(numbers),
                ::testing::ElementsAre(Vec3(0, 0, 1), Vec3(0.6, -0.8, 0), Vec3(1, 0, 0)));
}

TEST(VirtualScanViews, RaysFrame_IsRightHandedForAnyDirection) {
    const double number[] = {50};
    std::vector<Vec3> directions = scan::view_directions(number);
    directions.insert(directions.end(), {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}});
    for (const Vec3& direction : directions) {
        const scan::View view = scan::view_from(direction, Vec3::Zero(), 1);
        EXPECT_EQ(view.forward, -direction);
        EXPECT_NEAR(view.right.norm(), 1, 1e-15);
        EXPECT_NEAR(view.up.norm(), 1, 1e-15);
        EXPECT_NEAR(view.right.dot(view.up), 0, 1e-15);
        Eigen::Matrix3d axes;
        axes << view.right, view.up, direction;
        EXPECT_NEAR(axes.determinant(), 1, 1e-14);
    }
}

TEST(VirtualScan, Metrics_CountPointsAndOutliers) {
    VirtualScanParams params = sphere(0.1);
    params.outliers = Ratio::percent(10);
    Context context;
    const VirtualScanResult result = virtual_scan(nullptr, params, context);
    EXPECT_EQ(context.metrics().find("points")->value, static_cast<double>(result.points.size()));
    EXPECT_EQ(context.metrics().find("outliers")->value, static_cast<double>(result.outliers));
    EXPECT_EQ(context.metrics().find("dropped")->value, 0);
}

}  // namespace
}  // namespace scanmill::test
