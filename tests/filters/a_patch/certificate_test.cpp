// SPDX-License-Identifier: GPL-3.0-or-later
// The largest distance between surface and points, and the fit that keeps it.
#include "filters/a_patch/cases.hpp"
#include "support/point_sets.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::Not;

APatchParams within(double max_error) {
    APatchParams params;
    params.max_error = Length(max_error);
    return params;
}

/// Points of the torus of exact_torus(), with a wave of this height along the tube.
PointCloud wavy_torus(double height) {
    PointCloud points;
    Array<Vec3> positions;
    for (int i = 0; i < 240; ++i)
        for (int j = 0; j < 100; ++j) {
            const double u = 2 * std::numbers::pi * (i + 0.5 * (j % 2)) / 240, v = 2 * std::numbers::pi * j / 100;
            const Vec3 out(std::cos(u), std::sin(u), 0);
            positions.push_back(out +
                                (0.4 + height * std::cos(8 * v)) * (std::cos(v) * out + std::sin(v) * Vec3::UnitZ()));
        }
    points.positions = std::move(positions);
    return points;
}

TEST(Certificate, APointBesideASphere_IsTheFarthest_AndTheDoubtNamesItsPosition) {
    PointCloud points = fibonacci_sphere(4000);
    Array<Vec3> positions(points.positions.begin(), points.positions.end());
    const Vec3 out = 1.25 * positions[1234];
    positions[1234] = out;
    points.positions = std::move(positions);
    const PatchRun run = patched(exact_sphere(3), within(0.01), &points);
    ASSERT_TRUE(run.result.certificate);
    EXPECT_EQ(run.result.certificate->point.position, out);
    EXPECT_NEAR(run.result.certificate->point.distance, 0.25, 2e-3);
    EXPECT_EQ(run.result.certificate->beyond, 1u);
    EXPECT_EQ(run.result.certificate->surface.distance, 0);
    EXPECT_EQ(metric_of(run, "error"), run.result.certificate->point.distance);
    EXPECT_EQ(metric_of(run, "beyond"), 1);
    EXPECT_THAT(run.warnings,
                Contains(AllOf(HasSubstr("1 of 4000 points is farther from the surface than max-error, 0.01 u"),
                               HasSubstr(fmt::format("at ({:.6g}, {:.6g}, {:.6g})", out.x(), out.y(), out.z())))));
}

TEST(Certificate, ASurfaceWithoutPoints_IsAsFarAsTheNearestPoints) {
    PointCloud points = fibonacci_sphere(20000);
    Array<Vec3> positions;
    for (const Vec3& p : points.positions)
        if (p.z() < 0.8) positions.push_back(p);
    points.positions = std::move(positions);
    const PatchRun run = patched(exact_sphere(4), within(0.05), &points);
    ASSERT_TRUE(run.result.certificate);
    // From the pole to the rim: the chord of the angle whose cosine is 0.8, less a few spacings of 0.025.
    EXPECT_NEAR(run.result.certificate->surface.distance, std::sqrt(2 * (1 - 0.8)), 0.08);
    EXPECT_GT(run.result.certificate->surface.position.z(), 0.98);
    EXPECT_THAT(run.warnings, Contains(HasSubstr("farther from the nearest point than the points from each other")));
}

TEST(Certificate, TrianglesAreBisectedUntilThePointsAreWithinMaxError) {
    const TriangleMesh mesh = exact_torus(24, 10);
    const PointCloud points = wavy_torus(0.01);
    const PatchRun without = patched(mesh, {}, &points, 2), with = patched(mesh, within(2e-3), &points, 2);
    EXPECT_GT(metric_of(without, "fit-max"), 4e-3) << "the wave is lost";
    EXPECT_TRUE(std::isnan(metric_of(without, "error")));
    EXPECT_LT(metric_of(with, "error"), 2e-3);
    EXPECT_EQ(metric_of(with, "beyond"), 0);
    EXPECT_GT(metric_of(with, "refined"), metric_of(without, "refined"));
    EXPECT_THAT(with.warnings, Each(Not(HasSubstr("max-error"))));
    EXPECT_EQ(with.result.inverted + with.result.sign_violations + with.result.loosened, 0u);
}

TEST(Certificate, ALimitBelowTheNoise_IsDoubtful_AndCostsFewTriangles) {
    const PointCloud points = fibonacci_sphere(20000, 0.01);
    const PatchRun run = patched(exact_sphere(6), within(1e-3), &points, 2);
    EXPECT_GT(metric_of(run, "beyond"), 10000);
    EXPECT_LT(run.result.mesh.triangles.size(), 1.1 * 720);
    EXPECT_THAT(run.warnings, Contains(HasSubstr("farther from the surface than max-error")));
}

TEST(Certificate, APointFarAway_HasItsDistance_OnClosedAndOpenMeshes) {
    PointCloud points = fibonacci_sphere(4000);
    Array<Vec3> positions(points.positions.begin(), points.positions.end());
    positions.emplace_back(0, 0, 11);
    points.positions = positions;
    const PatchRun closed = patched(exact_sphere(3), within(0.5), &points);
    EXPECT_NEAR(closed.result.certificate->point.distance, 10, 0.01);
    EXPECT_EQ(closed.result.certificate->beyond, 1u);
    // Without the triangles below the equator; points there are beside the boundary.
    TriangleMesh open = geodesic_sphere(1, 4);
    Array<Triangle> upper;
    for (const Triangle& t : open.triangles)
        if (std::ranges::all_of(t, [&](u32 v) { return open.positions[v].z() > -0.1; })) upper.push_back(t);
    open.triangles = std::move(upper);
    Array<Vec3> above;
    for (const Vec3& p : positions)
        if (p.z() > -0.4) above.push_back(p);
    points.positions = std::move(above);
    const PatchRun half = patched(open, within(0.5), &points);
    EXPECT_NEAR(half.result.certificate->point.distance, 10, 0.01);
    EXPECT_EQ(half.result.certificate->beyond, 1u);
}

TEST(Certificate, AnyNumberOfThreads_GivesTheSameBits_AndBisectedEdgesAddTwoTriangles) {
    const TriangleMesh mesh = exact_torus(24, 10);
    const PointCloud points = wavy_torus(0.01);
    const PatchRun one = patched(mesh, within(2e-3), &points, 1), four = patched(mesh, within(2e-3), &points, 4);
    EXPECT_TRUE(std::ranges::equal(one.result.patches.weights, four.result.patches.weights));
    EXPECT_EQ(static_cast<double>(one.result.mesh.triangles.size()), 480 + 2 * metric_of(one, "refined"));
}

TEST(JointFit, OutliersOfOnePercent_BisectNothing) {
    const TriangleMesh mesh = exact_torus(48, 20);
    PointCloud points;
    points.positions = exact_torus(160, 64).positions;
    const PatchRun clean = patched(mesh, {}, &points, 2);
    Array<Vec3> positions(points.positions.begin(), points.positions.end());
    for (std::size_t i = 0; i < positions.size(); i += 100) positions[i] *= 1.01;
    points.positions = std::move(positions);
    const PatchRun with = patched(mesh, {}, &points, 2);
    EXPECT_LE(metric_of(with, "refined"), metric_of(clean, "refined") + 20);
}

TEST(Certificate, ThroughTheVertices_IsMeasuredOnly) {
    const PointCloud points = wavy_torus(0.01);
    APatchParams params = within(2e-3);
    params.interpolate = APatchParams::Interpolate::yes;
    const PatchRun run = patched(exact_torus(24, 10), params, &points, 2);
    EXPECT_GT(metric_of(run, "beyond"), 0);
    EXPECT_EQ(metric_of(run, "refined"), 0);
}

TEST(Certificate, NeedsPoints_AndALimitAboveZero) {
    const Error unwired = error_of([] { patched(exact_sphere(2), within(0.1)); });
    EXPECT_EQ(unwired.sentence(), "max-error needs points, and the input `points` is not wired");
    EXPECT_THAT(unwired.hint(), HasSubstr("in: {points: scan}"));
    const PointCloud none;
    EXPECT_EQ(error_of([&] { patched(exact_sphere(2), within(0.1), &none); }).sentence(),
              "max-error needs points, and the input `points` is empty");
    const PointCloud points = fibonacci_sphere(100);
    for (const double wrong : {0.0, -1.0, std::nan("")}) {
        const Error error = error_of([&] { patched(exact_sphere(2), within(wrong), &points); });
        EXPECT_THAT(error.sentence(), HasSubstr("max-error must be above 0"));
        EXPECT_FALSE(error.hint().empty());
    }
}

}  // namespace
}  // namespace scanmill
