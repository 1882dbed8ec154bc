// SPDX-License-Identifier: GPL-3.0-or-later
/// decimate with data points beside the mesh.
#include <gmock/gmock.h>

#include "filters/decimate/cases.hpp"

namespace scanmill::test {
namespace {

/// Points spread over the unit sphere, half of them `offset` outside and half inside.
PointCloud points_beside_the_sphere(std::size_t count, double offset) {
    Random random(11);
    Array<Vec3> positions;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 direction = Vec3(random.normal(), random.normal(), random.normal()).normalized();
        positions.push_back(direction * (1 + (i % 2 == 0 ? offset : -offset)));
    }
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}

PointCloud with_point(const PointCloud& cloud, const Vec3& point) {
    Array<Vec3> positions(cloud.positions.begin(), cloud.positions.end());
    positions.push_back(point);
    PointCloud result = cloud;
    result.positions = std::move(positions);
    return result;
}

/// The largest distance from a point to the mesh, over all triangles.
double farthest(const PointCloud& points, const TriangleMesh& mesh) {
    double largest = 0;
    for (const Vec3& p : points.positions) {
        double least = 1e300;
        for (const auto& [a, b, c] : mesh.triangles)
            least = std::min(
                least,
                (p - nearest_on_triangle(p, mesh.positions[a], mesh.positions[b], mesh.positions[c])).squaredNorm());
        largest = std::max(largest, least);
    }
    return std::sqrt(largest);
}

TEST(DecimateWithPoints, PointsBesideASphere_StayWithinMaxError) {
    constexpr double max_error = 0.02;
    const TriangleMesh fine = geodesic_sphere(1, 24);
    const PointCloud points = points_beside_the_sphere(1000, max_error / 2);
    const DecimateResult result = decimated(fine, within(max_error), &points);
    expect_laws(fine, result, max_error);
    ASSERT_TRUE(result.points_max);
    EXPECT_LE(*result.points_max, max_error);
    EXPECT_NEAR(*result.points_max, farthest(points, result.mesh), 1e-12);
    EXPECT_EQ(result.points_beyond, 0u);
    EXPECT_EQ(result.points_left_out, 0u);
    // They cost triangles: without them some would be farther.
    const DecimateResult free = decimated(fine, max_error);
    EXPECT_LT(free.mesh.triangles.size(), result.mesh.triangles.size());
    EXPECT_GT(farthest(points, free.mesh), max_error);
    EXPECT_FALSE(free.points_max);
}

TEST(DecimateWithPoints, PointFartherThanMaxError_IsLeftOutAndCounted) {
    constexpr double max_error = 0.02;
    const TriangleMesh fine = geodesic_sphere(1, 24);
    const PointCloud points = points_beside_the_sphere(1000, max_error / 2);
    const PointCloud more = with_point(points, Vec3(0, 0, 1 + 2 * max_error));
    const DecimateResult result = decimated(fine, within(max_error), &more);
    EXPECT_EQ(result.points_left_out, 1u);
    EXPECT_EQ(result.points_beyond, 1u);
    EXPECT_NEAR(*result.points_max, 2 * max_error, max_error);
    EXPECT_TRUE(same_mesh(result.mesh, decimated(fine, within(max_error), &points).mesh)) << "the rest as before";
}

TEST(DecimateWithPoints, PointsFarFromTheMesh_AreAllLeftOut) {
    const TriangleMesh fine = geodesic_sphere(1, 12);
    const PointCloud far = cloud_of({{50, 0, 0}, {0, -1e6, 0}, {0, 0, 0}});
    const DecimateResult result = decimated(fine, within(0.02), &far);
    EXPECT_EQ(result.points_left_out, 3u);
    EXPECT_EQ(result.points_beyond, 3u);
    EXPECT_NEAR(*result.points_max, 1e6, 2);
    Context context;
    decimate(fine, &far, within(0.02), context);
    EXPECT_EQ(context.warnings(),
              std::vector<std::string>{"3 of the 3 points are farther than max-error from the input "
                                       "mesh; they do not limit the result"});
    EXPECT_TRUE(same_mesh(result.mesh, decimated(fine, 0.02).mesh));
}

TEST(DecimateWithPoints, OnePointAboveAFlatGrid_KeepsAVertexNear) {
    // The square alone would become two triangles. The point is 0.04 above the middle vertex, which is 0.02 high.
    const TriangleMesh flat =
        with_positions(grid(8, 8), [](const Vec3& p) -> Vec3 { return p == Vec3(4, 4, 0) ? Vec3(4, 4, 0.02) : p; });
    EXPECT_EQ(decimated(flat, 0.05).mesh.triangles.size(), 2u);
    const PointCloud above = cloud_of({{4, 4, 0.06}});
    const DecimateResult result = decimated(flat, within(0.05), &above);
    EXPECT_GT(result.mesh.triangles.size(), 2u);
    EXPECT_NE(std::ranges::find(result.mesh.positions, Vec3(4, 4, 0.02)), result.mesh.positions.end());
    EXPECT_LE(*result.points_max, 0.05);
}

TEST(DecimateWithPoints, Accumulated_OnlyMeasuresThem) {
    const TriangleMesh fine = geodesic_sphere(1, 16);
    const PointCloud points = points_beside_the_sphere(500, 0.015);
    DecimateParams params = within(0.02);
    params.mode = DecimateMode::accumulated;
    const DecimateResult result = decimated(fine, params, &points);
    EXPECT_TRUE(same_mesh(result.mesh, decimated(fine, params).mesh));
    EXPECT_NEAR(*result.points_max, farthest(points, result.mesh), 1e-12);
    std::size_t beyond = 0;
    for (const Vec3& p : points.positions) beyond += farthest(cloud_of({p}), result.mesh) > 0.02;
    EXPECT_EQ(result.points_beyond, beyond);
}

TEST(DecimateWithPoints, AnotherOrigin_IsAllowedFor) {
    const TriangleMesh fine = geodesic_sphere(1, 16);
    const PointCloud points = points_beside_the_sphere(500, 0.01);
    PointCloud elsewhere = points;
    elsewhere.frame.origin = Vec3(1024, -512, 64);
    Array<Vec3> positions;
    for (const Vec3& p : points.positions) positions.push_back(p - elsewhere.frame.origin);
    elsewhere.positions = std::move(positions);
    const DecimateResult one = decimated(fine, within(0.02), &points),
                         other = decimated(fine, within(0.02), &elsewhere);
    EXPECT_NEAR(*one.points_max, *other.points_max, 1e-3);
    EXPECT_EQ(other.points_left_out, 0u);
    EXPECT_EQ(other.points_beyond, 0u);
}

TEST(DecimateWithPoints, NoPoints_AreNoneBeyond) {
    const PointCloud none;
    const DecimateResult result = decimated(geodesic_sphere(1, 8), within(0.05), &none);
    EXPECT_EQ(result.points_max, 0.0);
    EXPECT_EQ(result.points_beyond, 0u);
}

TEST(DecimateWithPoints, Metrics_AreReported) {
    const PointCloud points = points_beside_the_sphere(100, 0.01);
    Context context;
    const DecimateResult result = decimate(geodesic_sphere(1, 12), &points, within(0.02), context);
    std::map<std::string, double> metrics;
    for (const Metric& metric : context.metrics().values) metrics[metric.name] = metric.value;
    EXPECT_EQ(metrics.at("triangles"), static_cast<double>(result.mesh.triangles.size()));
    EXPECT_EQ(metrics.at("removed"), static_cast<double>(result.removed));
    EXPECT_EQ(metrics.at("flips"), static_cast<double>(result.flips));
    EXPECT_EQ(metrics.at("hausdorff-lower"), result.certificate.lower);
    EXPECT_EQ(metrics.at("hausdorff-upper"), result.certificate.upper);
    EXPECT_EQ(metrics.at("certified"), 1);
    EXPECT_EQ(metrics.at("creases"), 0);
    EXPECT_EQ(metrics.at("corners"), 0);
    EXPECT_EQ(metrics.at("points-max"), *result.points_max);
    EXPECT_EQ(metrics.at("points-beyond"), 0);
}

}  // namespace
}  // namespace scanmill::test
