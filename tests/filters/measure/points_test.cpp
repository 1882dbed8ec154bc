// SPDX-License-Identifier: GPL-3.0-or-later
/// measure against a cloud of points.
#include <gmock/gmock.h>

#include "filters/measure/cases.hpp"
#include "support/point_sets.hpp"

namespace scanmill::test {
namespace {

TEST(MeasureAgainstPoints, Points_AreTheSamples) {
    // 0.5 above, 0.25 below, on the square, and 1 beside it.
    MeasureParams params = few_samples();
    params.thresholds = {0.25};
    const Measurement result =
        measured(rectangle(2, 2), cloud_of({{1, 1, 0.5}, {0.5, 1.5, -0.25}, {1.25, 1.75, 0}, {3, 1, 0}}), params);
    EXPECT_EQ(result.from_truth.samples, 4u);
    EXPECT_DOUBLE_EQ(result.from_truth.mean, 1.75 / 4);
    EXPECT_DOUBLE_EQ(result.from_truth.rms, std::sqrt((0.25 + 0.0625 + 1) / 4));
    EXPECT_DOUBLE_EQ(result.from_truth.p50, 0.25);
    EXPECT_DOUBLE_EQ(result.from_truth.p90, 1);
    EXPECT_DOUBLE_EQ(result.from_truth.max, 1);
    EXPECT_EQ(result.both.mean, result.from_truth.mean);
    EXPECT_EQ(result.near.at(0).recall, 0.5);
}

TEST(MeasureAgainstPoints, TheOtherDirection_HasAnotherName) {
    const Measurement result = measured(rectangle(1, 1), vertices_of(rectangle(1, 1)));
    EXPECT_FALSE(result.to_truth);
    EXPECT_FALSE(result.hausdorff);
    EXPECT_FALSE(result.chamfer);
    EXPECT_FALSE(result.normal_consistency);
    EXPECT_EQ(result.from_truth.max, 0);
    // From a uniform point of the unit square to the nearest corner: as to the centre, (√2 + ln(1 + √2)) / 6.
    ASSERT_TRUE(result.to_points);
    EXPECT_NEAR(result.to_points->mean, (std::sqrt(2) + std::log(1 + std::sqrt(2))) / 6, 2e-3);
    const Metrics metrics = metrics_of(result);
    for (const char* name : {"hausdorff", "chamfer", "mean-to-truth", "f-score", "precision", "truth-area"})
        EXPECT_EQ(metrics.find(name), nullptr) << name;
    EXPECT_NE(metrics.find("mean-to-points"), nullptr);
    EXPECT_NE(metrics.find("max"), nullptr);
}

TEST(MeasureAgainstPoints, AnyNumberOfThreads_GivesTheSameNumbers) {
    const TriangleMesh sphere = geodesic_sphere(1, 20);
    const PointCloud cloud = random_sphere(20'000, 3);
    const Metrics one = metrics_of(measured(sphere, cloud, few_samples(), 1));
    EXPECT_EQ(metrics_of(measured(sphere, cloud, few_samples(), 3)).values, one.values);
}

TEST(MeasureAgainstPoints, StrayPoint_IsMeasuredAndDoesNotDecideWhetherTheFramesAgree) {
    const PointCloud sphere = random_sphere(20'000, 3);
    const PointCloud scan = joined(sphere, cloud_of({{0, 0, 1000}}));
    const Measurement result = measured(geodesic_sphere(1, 20), scan, few_samples());
    EXPECT_EQ(result.from_truth.samples, 20'001u);
    EXPECT_NEAR(result.from_truth.max, 999, 1e-2);
}

TEST(MeasureAgainstPoints, OnePoint_IsMeasured) {
    const Measurement result = measured(cube(), cloud_of({{0.5, 0.5, 0.75}}), few_samples());
    EXPECT_DOUBLE_EQ(result.from_truth.mean, 0.25);
    EXPECT_DOUBLE_EQ(result.from_truth.max, 0.25);
    EXPECT_FALSE(result.from_truth.mean_spread) << "nothing was sampled";
    EXPECT_TRUE(result.to_points->mean_spread);
}

TEST(MeasureAgainstPoints, FewPointsOnALargePart_AreNotAnotherUnit) {
    const Measurement result = measured(scaled(cube(), 100), cloud_of({{50, 50, 99}, {50, 51, 99}}), few_samples());
    EXPECT_DOUBLE_EQ(result.from_truth.max, 1);
}

}  // namespace
}  // namespace scanmill::test
