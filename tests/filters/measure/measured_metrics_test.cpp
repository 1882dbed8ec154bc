// SPDX-License-Identifier: GPL-3.0-or-later
/// The metric names of a measurement.
#include <gtest/gtest.h>

#include <cmath>

#include "filters/measure/cases.hpp"

namespace scanmill::test {
namespace {

TEST(MeasuredMetrics, AgainstAMesh_HaveBothSides) {
    MeasureParams params = few_samples();
    params.thresholds = {0.25, 0.5};
    params.certify = true;
    const Metrics metrics = metrics_of(measured(shifted(cube(), {0.1, 0, 0}), cube(), params));
    for (const char* name : {"mean",
                             "mean-spread",
                             "rms",
                             "p50",
                             "p90",
                             "p95",
                             "p99",
                             "max",
                             "mean-to-truth",
                             "max-from-truth",
                             "hausdorff",
                             "chamfer",
                             "f-score",
                             "f-score@2",
                             "precision@2",
                             "recall@2",
                             "normal-consistency",
                             "normal-consistency-unsigned",
                             "volume",
                             "area",
                             "components",
                             "genus",
                             "boundary-loops",
                             "closed",
                             "self-intersections",
                             "min-angle",
                             "aspect-ratio-p95",
                             "truth-volume",
                             "truth-genus",
                             "hausdorff-lower",
                             "hausdorff-upper",
                             "certified"})
        EXPECT_NE(metrics.find(name), nullptr) << name;
    EXPECT_EQ(metrics.find("mean-to-points"), nullptr);
    EXPECT_EQ(metrics.find("hausdorff")->unit, Unit::length);
    EXPECT_EQ(metrics.find("volume")->unit, Unit::volume);
}

TEST(MeasuredMetrics, Thresholds_AreNumberedInTheirOrder) {
    MeasureParams params = few_samples();
    params.thresholds = {0.5, Length::percent_of_diagonal(10), 0.05};
    const Metrics metrics = metrics_of(measured(shifted(cube(), {0.1, 0, 0}), cube(), params));
    EXPECT_EQ(metrics.find("threshold")->value, 0.5);
    EXPECT_NEAR(metrics.find("threshold@2")->value, 0.1 * std::sqrt(3.0), 1e-15);
    EXPECT_EQ(metrics.find("threshold@3")->value, 0.05);
    EXPECT_EQ(metrics.find("f-score")->value, 1);
    EXPECT_LT(metrics.find("f-score@3")->value, 1);
    EXPECT_EQ(metrics.find("threshold@1"), nullptr);
}

TEST(MeasuredMetrics, VertexInNoTriangle_ChangesNoNumber) {
    for (const double far : {1e3, 1e10, 1e300}) {
        TriangleMesh mesh = geodesic_sphere(1, 5);
        Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
        positions.push_back({far, far, far});
        mesh.positions = std::move(positions);
        const Metrics with = metrics_of(measured(mesh, shifted(geodesic_sphere(1, 5), {0.1, 0, 0}), few_samples()));
        const Metrics without =
            metrics_of(measured(geodesic_sphere(1, 5), shifted(geodesic_sphere(1, 5), {0.1, 0, 0}), few_samples()));
        for (const Metric& metric : without.values) {
            if (metric.name == "unused-vertices") continue;
            EXPECT_EQ(with.find(metric.name)->value, metric.value) << metric.name << " " << far;
        }
        EXPECT_EQ(with.find("unused-vertices")->value, 1);
    }
}

TEST(MeasuredMetrics, UnitAndDiagonal_AreThoseOfTheMesh) {
    TriangleMesh mesh = cube();
    mesh.frame.unit = LengthUnit::millimetre;
    const Metrics metrics = metrics_of(measured(mesh, cube(), few_samples()));
    EXPECT_EQ(metrics.unit, LengthUnit::millimetre);
    EXPECT_NEAR(metrics.find("diagonal")->value, std::sqrt(3.0), 1e-15);
}

}  // namespace
}  // namespace scanmill::test
