// SPDX-License-Identifier: GPL-3.0-or-later
/// Distances of measure against closed forms.
#include "filters/measure/cases.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "support/point_sets.hpp"

namespace scanmill::test {
namespace {

TEST(Measure, ThinTriangles_HaveDistanceZeroToThemselves) {
    for (double height = 0.3; height > 1e-9; height /= 3) {
        const Vec3 a(0.1, 0.2, 0.3), b(2.1, 2.2, 1.3), up = 3 * height * Vec3(1, -1, 0).normalized();
        const TriangleMesh strip = soup({a, b, a + 0.3 * (b - a) + up, b + up}, {{0, 1, 2}, {1, 3, 2}});
        const Measurement result = measured(strip, strip, certified());
        EXPECT_EQ(result.both.max, 0) << height;
        EXPECT_LE(*result.hausdorff, result.certified->upper) << height;
    }
}

TEST(Measure, MeshAgainstItself_IsExactlyZero) {
    for (const TriangleMesh& mesh : {cube(), l_block(), geodesic_sphere(3, 12), torus(2, 0.5, 40, 20),
                                     turned(shifted(torus(2, 0.5, 30, 11), {5, -3, 1}), 0.7, {1, 2, 3})}) {
        MeasureParams params = certified();
        params.thresholds = {1e-300};
        const Measurement result = measured(mesh, mesh, params);
        EXPECT_EQ(result.both.max, 0);
        EXPECT_EQ(result.both.mean, 0);
        EXPECT_EQ(result.both.rms, 0);
        EXPECT_EQ(result.hausdorff, 0.0);
        EXPECT_EQ(result.chamfer, 0.0);
        EXPECT_EQ(result.near.at(0).f_score, 1.0);
        EXPECT_EQ(result.certified->upper, 0);
        EXPECT_TRUE(result.certified->reached);
        EXPECT_NEAR(*result.normal_consistency, 1, 1e-12);
    }
}

TEST(Measure, ParallelRectangles_HaveTheirDistanceEverywhere) {
    // 3 × 4 at height 0, 0.25 below another: all numbers are 0.25 in both directions.
    const Measurement result = measured(rectangle(3, 4), rectangle(3, 4, 0.25));
    for (const DistanceNumbers& numbers : {*result.to_truth, result.from_truth, result.both}) {
        EXPECT_DOUBLE_EQ(numbers.mean, 0.25);
        EXPECT_DOUBLE_EQ(numbers.rms, 0.25);
        EXPECT_DOUBLE_EQ(numbers.p50, 0.25);
        EXPECT_DOUBLE_EQ(numbers.p99, 0.25);
        EXPECT_DOUBLE_EQ(numbers.max, 0.25);
        EXPECT_LT(numbers.mean_spread, 1e-15);
    }
    EXPECT_DOUBLE_EQ(*result.hausdorff, 0.25);
    EXPECT_DOUBLE_EQ(*result.chamfer, 0.25);
}

TEST(Measure, TheTwoDirections_ShowSurplusAndMissingSurface) {
    // The mesh covers a third of the truth: no surplus, two thirds missing at distances 0 … 2.
    const Measurement result = measured(rectangle(1, 1), rectangle(3, 1), [] {
        MeasureParams params;
        params.thresholds = {0.5, 2.0};
        return params;
    }());
    EXPECT_EQ(result.to_truth->max, 0);
    EXPECT_EQ(result.to_truth->mean, 0);
    EXPECT_DOUBLE_EQ(result.from_truth.max, 2);
    EXPECT_NEAR(result.from_truth.mean, 2.0 / 3, 5e-3);              // (1/3) ∫₀² x dx
    EXPECT_NEAR(result.from_truth.rms, std::sqrt(8.0 / 9), 5e-3);    // (1/3) ∫₀² x² dx
    EXPECT_NEAR(result.from_truth.p50, 0.5, 1e-2);
    EXPECT_NEAR(result.from_truth.p90, 1.7, 1e-2);
    EXPECT_NEAR(result.from_truth.p99, 1.97, 1e-2);
    EXPECT_DOUBLE_EQ(*result.hausdorff, 2);
    EXPECT_EQ(*result.chamfer, (result.to_truth->mean + result.from_truth.mean) / 2);
    EXPECT_EQ(result.both.mean, *result.chamfer);
    EXPECT_EQ(result.near[0].precision, 1.0);
    EXPECT_NEAR(result.near[0].recall, 0.5, 5e-3);
    EXPECT_NEAR(*result.near[0].f_score, 2.0 / 3, 5e-3);
    EXPECT_EQ(result.near[1].recall, 1.0);
}

TEST(Measure, ShiftedBox_IsItsShiftAwayAtMost) {
    for (double shift : {0.3, 0.01, 1e-6}) {
        const Measurement result = measured(shifted(cube(), {shift, 0, 0}), cube(), certified());
        EXPECT_NEAR(*result.hausdorff, shift, 1e-13);
        EXPECT_LE(result.certified->lower, shift);
        EXPECT_GE(result.certified->upper, shift);
        EXPECT_TRUE(result.certified->reached);
    }
}

TEST(Measure, ScaledBox_IsTheDistanceOfItsCorners) {
    // [0, 1]³ in [-0.2, 1.2]³: the corner (1.2, 1.2, 1.2) is √3 · 0.2 from (1, 1, 1); back it is 0.2 from everywhere.
    const TriangleMesh large = shifted(scaled(cube(), 1.4), {-0.2, -0.2, -0.2});
    const Measurement result = measured(large, cube());
    EXPECT_NEAR(result.to_truth->max, 0.2 * std::numbers::sqrt3, 1e-12);
    EXPECT_NEAR(result.from_truth.max, 0.2, 1e-12);
    EXPECT_NEAR(result.from_truth.mean, 0.2, 1e-12);
}

TEST(Measure, BoxTurnedAboutItsAxis_IsTheDistanceOfItsEdgeToTheFace) {
    // A unit square turned by 45° about its centre: its corner is 1/√2 - 1/2 outside the other's edge.
    const TriangleMesh centred = shifted(cube(), {-0.5, -0.5, -0.5});
    const Measurement result = measured(turned(centred, std::numbers::pi / 4, Vec3::UnitZ()), centred, certified());
    const double expected = 1 / std::numbers::sqrt2 - 0.5;
    EXPECT_NEAR(result.to_truth->max, expected, 1e-12);
    EXPECT_LE(result.certified->lower, expected);
    EXPECT_GE(result.certified->upper, expected);
    EXPECT_LE(result.certified->upper, expected / 0.98);
}

TEST(Measure, ConcentricIcosahedra_AreTheirVerticesApart) {
    // A vertex of the larger is R - r from the nearest point of the smaller, the vertex below it. A face of the smaller
    // is (R - r) times the inradius of the unit icosahedron from the face above it.
    const double inradius = std::sqrt((5 + 2 * std::sqrt(5.0)) / 15);
    const Measurement result = measured(icosahedron(1.5), icosahedron(1), certified());
    EXPECT_NEAR(result.to_truth->max, 0.5, 1e-12);
    EXPECT_NEAR(result.from_truth.max, 0.5 * inradius, 1e-12);
    EXPECT_NEAR(result.from_truth.mean, 0.5 * inradius, 1e-12);
    EXPECT_LE(result.certified->lower, 0.5);
    EXPECT_GE(result.certified->upper, 0.5);
}

TEST(Measure, ConcentricSpheres_AreTheDifferenceOfRadiiApart) {
    const double inner = 1, outer = 1.25;
    const Measurement result = measured(geodesic_sphere(outer, 20), geodesic_sphere(inner, 20), certified());
    // The triangles are within a sagitta of the sphere: 1 - cos(half of the largest edge's angle).
    const double sagitta = outer * (1 - std::cos(std::atan(2.0) / 20 * 0.8));
    EXPECT_NEAR(result.both.mean, outer - inner, sagitta);
    EXPECT_NEAR(*result.hausdorff, outer - inner, sagitta);
    EXPECT_LE(result.certified->lower, outer - inner + sagitta);
    EXPECT_GE(result.certified->upper, outer - inner - 1e-12);
    EXPECT_LE(result.certified->upper - result.certified->lower, 0.01 * result.certified->upper + 1e-12);
}

/// A roof over the unit square, and the square together with the roof: from the square's centre it is 0.5 / √2 to the
/// roof; all vertices of both surfaces have distance 0.
std::pair<TriangleMesh, TriangleMesh> roof_and_house() {
    const TriangleMesh roof = soup({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0, 0.5}, {0.5, 1, 0.5}},
                                   {{0, 4, 5}, {0, 5, 3}, {4, 1, 2}, {4, 2, 5}});
    return {roof, both(rectangle(1, 1), roof)};
}

TEST(Measure, HausdorffBetweenSamples_IsFoundWithoutCertify) {
    const auto& [roof, house] = roof_and_house();
    MeasureParams params;
    params.samples = fewest_samples;
    params.gap = Ratio::percent(0.1);
    const Measurement result = measured(roof, house, params);
    const double truth = 0.5 / std::numbers::sqrt2;
    EXPECT_LT(result.both.max, 0.99 * truth) << "no sample is near the centre";
    EXPECT_GE(*result.hausdorff, 0.999 * truth);
    EXPECT_LE(*result.hausdorff, truth * (1 + 1e-14));
    EXPECT_FALSE(result.certified);
}

TEST(Measure, HausdorffWithFewCuts_IsNotBelowItsBoundsNorTheSamples) {
    const TriangleMesh mesh = turned(torus(2, 0.5, 40, 20), 0.1, {1, 2, 3}), truth = torus(2, 0.5, 33, 21);
    MeasureParams params = certified(1e-7);
    for (const u64 cuts : {1u, 8u, 64u, 512u}) {
        params.most_cuts = cuts;
        const Measurement result = measured(mesh, truth, params);
        EXPECT_FALSE(result.certified->reached);
        EXPECT_GE(*result.hausdorff, result.both.max);
        EXPECT_GE(*result.hausdorff, result.certified->lower);
        EXPECT_LE(*result.hausdorff, result.certified->upper);
    }
}

TEST(Measure, HausdorffOfDecimatedMeshes_AgreesWithTheCertifiedOne) {
    for (const TriangleMesh& truth :
         {geodesic_sphere(1, 30), torus(2, 0.5, 120, 60), l_block(3), turned(torus(1, 0.2, 90, 30), 0.3, {1, 2, 3})})
        for (const double size : {0.1, 0.3}) {
            const TriangleMesh mesh = clustered(truth, size);
            MeasureParams params = few_samples();
            const Measurement found = measured(mesh, truth, params);
            const Measurement exact = measured(mesh, truth, certified());
            EXPECT_GE(*exact.hausdorff, exact.certified->lower);
            EXPECT_GE(*exact.hausdorff, exact.both.max);
            EXPECT_LE(*exact.hausdorff, exact.certified->upper);
            EXPECT_GE(*found.hausdorff, 0.98 * exact.certified->lower);
            EXPECT_LE(*found.hausdorff, exact.certified->upper);
        }
}

TEST(Measure, MeanSpread_CoversTheErrorOfTheMean) {
    // The mean in closed form is within 4 standard errors for each of 20 seeds.
    const double expected = 2.0 / 3;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        ContextOptions options;
        options.seed = seed;
        Context context(options);
        const Measurement result = measure(rectangle(1, 1), rectangle(3, 1), few_samples(), context);
        EXPECT_GT(result.from_truth.mean_spread, 0);
        EXPECT_LT(std::abs(result.from_truth.mean - expected), 4 * *result.from_truth.mean_spread) << seed;
    }
}

TEST(Measure, Vertices_CountForTheMaximumAlone) {
    // A needle of area 5e-13 and height 0.4: it gets no sample, but its tip is a vertex.
    TriangleMesh spiked =
        both(rectangle(1, 1), soup({{0.5, 0.5, 0}, {0.5 + 1e-12, 0.5, 0}, {0.5, 0.5, 0.4}}, {{0, 1, 2}}));
    const Measurement result = measured(spiked, rectangle(1, 1));
    EXPECT_DOUBLE_EQ(result.to_truth->max, 0.4);
    EXPECT_EQ(result.to_truth->mean, 0);
    EXPECT_EQ(result.to_truth->p99, 0);
}

TEST(Measure, MeshInsideOut_ChangesSignedNormalsOnly) {
    const TriangleMesh sphere = geodesic_sphere(1, 10);
    const Measurement result = measured(inside_out(sphere), sphere);
    EXPECT_NEAR(*result.normal_consistency, -1, 1e-12);
    EXPECT_NEAR(*result.normal_consistency_unsigned, 1, 1e-12);
    EXPECT_EQ(*result.hausdorff, 0);
}

TEST(Measure, PerpendicularPlanes_HaveNoCosine) {
    const TriangleMesh wall = turned(rectangle(1, 1), std::numbers::pi / 2, Vec3::UnitX());
    const Measurement result = measured(rectangle(1, 1), wall, few_samples());
    EXPECT_NEAR(*result.normal_consistency, 0, 1e-12);
    EXPECT_NEAR(*result.normal_consistency_unsigned, 0, 1e-12);
}

TEST(Measure, DegenerateTriangles_ArePartOfTheSurfaceWithoutNormals) {
    // A segment from the square's corner upwards, as a triangle: 1 high.
    const TriangleMesh mast = both(rectangle(1, 1), soup({{1, 1, 0}, {1, 1, 0.5}, {1, 1, 1}}, {{0, 1, 2}}));
    const TriangleMesh flag = both(rectangle(1, 1), soup({{1, 1, 1}, {1, 0.9, 1}, {1, 1, 1.1}}, {{0, 1, 2}}));
    const Measurement result = measured(flag, mast);
    EXPECT_GT(result.without_normal, 0u);
    EXPECT_NEAR(result.to_truth->max, 0.1, 1e-15);
    EXPECT_EQ(result.truth->collinear_triangles, 1u);
    EXPECT_EQ(result.truth->least_angle, 0);
    EXPECT_TRUE(std::isfinite(result.truth->largest_aspect));
}

TEST(Measure, UnusedVertices_AreNotPartOfTheSurface) {
    TriangleMesh mesh = soup({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0.9}}, {{0, 1, 2}, {0, 2, 3}});
    const Measurement result = measured(mesh, rectangle(1, 1), certified());
    EXPECT_EQ(*result.hausdorff, 0);
    EXPECT_EQ(result.certified->upper, 0);
    EXPECT_EQ(result.mesh.topology.unused_vertices, 1u);
}

TEST(Measure, AnyNumberOfThreads_GivesTheSameNumbers) {
    MeasureParams params = certified();
    params.samples = 20'000;
    params.thresholds = {0.01, 0.1};
    const TriangleMesh mesh = turned(torus(2, 0.5, 60, 30), 0.1, {1, 1, 0}), truth = torus(2, 0.55, 47, 33);
    const Metrics one = metrics_of(measured(mesh, truth, params, 1));
    for (unsigned threads : {2u, 3u}) {
        const Metrics other = metrics_of(measured(mesh, truth, params, threads));
        ASSERT_EQ(one.values.size(), other.values.size());
        for (std::size_t i = 0; i < one.values.size(); ++i)
            EXPECT_EQ(one.values[i], other.values[i]) << one.values[i].name;
    }
}

TEST(Measure, AnotherSeed_TakesOtherSamples) {
    const TriangleMesh mesh = torus(2, 0.5, 20, 10), truth = torus(2, 0.55, 20, 10);
    ContextOptions options;
    options.seed = 7;
    Context context(options);
    EXPECT_NE(measure(mesh, truth, few_samples(), context).both.mean, measured(mesh, truth, few_samples()).both.mean);
}

TEST(Measure, AskedToStop_Stops) {
    ContextOptions options;
    options.is_cancelled = [] { return true; };
    Context context(options);
    EXPECT_THROW(measure(cube(), cube(), few_samples(), context), Cancelled);
}

}  // namespace
}  // namespace scanmill::test
