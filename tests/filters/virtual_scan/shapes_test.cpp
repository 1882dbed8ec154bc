// SPDX-License-Identifier: GPL-3.0-or-later
/// Shapes scanned by formula: every point satisfies the formula, and the number of points the projected area.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "filters/virtual_scan/cases.hpp"
#include "virtual_scan/sign_changes.hpp"

namespace scanmill::test {
namespace {

VirtualScanParams shape_of(Shape shape, std::vector<Length> size, double resolution) {
    VirtualScanParams params;
    params.shape = shape;
    params.size = std::move(size);
    params.resolution = resolution;
    params.max_angle = Angle::degrees(90);
    return params;
}

std::size_t points_of_view(const PointCloud& cloud, std::int32_t view) {
    return static_cast<std::size_t>(std::ranges::count(cloud.columns.find("view")->values<std::int32_t>(), view));
}

/// Every normal has length 1, is `expected(position)`, and faces its view's sensor.
template <class Expected>
void expect_normals(const VirtualScanResult& result, Expected&& expected, double tolerance) {
    const auto views = result.points.columns.find("view")->values<std::int32_t>();
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        const Vec3 normal = normal_of(result.points, i);
        ASSERT_NEAR(normal.norm(), 1, 1e-12);
        ASSERT_GE(normal.dot(result.directions[static_cast<std::size_t>(views[i])]), -1e-9) << i;
        ASSERT_LT((normal - expected(result.points.positions[i])).norm(), tolerance) << i;
    }
}

TEST(VirtualScanShapes, Sphere_EveryPointLiesOnIt) {
    const double radius = 12.5;
    const VirtualScanResult result = scan(shape_of(Shape::sphere, {radius}, 0.3));
    ASSERT_GT(result.points.size(), 10000u);
    for (const Vec3& p : result.points.positions) ASSERT_NEAR(p.norm(), radius, 1e-12 * radius);
    expect_normals(
        result, [&](const Vec3& p) { return Vec3(p / radius); }, 1e-12);
}

TEST(VirtualScanShapes, Sphere_EveryViewSeesItsDisc) {
    const VirtualScanResult result = scan(shape_of(Shape::sphere, {1.0}, 0.01));
    for (std::int32_t view = 0; view < 12; ++view)
        // The circle problem: the number of grid points in a disc of 100 steps' radius is right to a few parts in 10^4.
        EXPECT_NEAR(static_cast<double>(points_of_view(result.points, view)) * 1e-4, pi, 0.002 * pi);
}

TEST(VirtualScanShapes, MaxAngle_CutsTheSphereToACap) {
    VirtualScanParams params = shape_of(Shape::sphere, {1.0}, 0.01);
    params.max_angle = Angle::degrees(30);
    const VirtualScanResult result = scan(params);
    EXPECT_NEAR(static_cast<double>(points_of_view(result.points, 0)) * 1e-4, pi * 0.25, 0.005);
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        const auto view = result.points.columns.find("view")->values<std::int32_t>()[i];
        ASSERT_GT(normal_of(result.points, i).dot(result.directions[static_cast<std::size_t>(view)]),
                  std::sqrt(3) / 2 - 1e-12);
    }
}

TEST(VirtualScanShapes, Torus_EveryPointLiesOnItWithItsNormal) {
    const VirtualScanResult result = scan(shape_of(Shape::torus, {5.0, 2.0}, 0.08));
    ASSERT_GT(result.points.size(), 10000u);
    double innermost = 10;
    for (const Vec3& p : result.points.positions) {
        const double ring = std::hypot(p.x(), p.y());
        ASSERT_NEAR(std::hypot(ring - 5, p.z()), 2, 1e-9);
        innermost = std::min(innermost, ring);
    }
    EXPECT_LT(innermost, 3.1) << "some view looks into the hole";
    expect_normals(
        result,
        [](const Vec3& p) {
            const Vec3 centre = 5 * Vec3(p.x(), p.y(), 0).normalized();
            return Vec3((p - centre).normalized());
        },
        1e-6);
}

TEST(VirtualScanShapes, TorusFromAbove_ShowsItsRing) {
    VirtualScanParams params = shape_of(Shape::torus, {5.0, 2.0}, 0.02);
    params.views = {0, 0, 1};
    const VirtualScanResult result = scan(params);
    EXPECT_NEAR(static_cast<double>(result.points.size()) * 4e-4, pi * (49 - 9), 0.001 * pi * 40);
    for (const Vec3& p : result.points.positions) ASSERT_GE(p.z(), 0);
}

TEST(VirtualScanShapes, TorusFromTheSide_HidesItsFarHalf) {
    VirtualScanParams params = shape_of(Shape::torus, {5.0, 2.0}, 0.02);
    params.views = {1, 0, 0};
    const VirtualScanResult result = scan(params);
    // The silhouette: a rectangle and two half discs.
    EXPECT_NEAR(static_cast<double>(result.points.size()) * 4e-4, 10 * 4 + pi * 4, 0.05);
    for (const Vec3& p : result.points.positions) ASSERT_GE(p.x(), -1e-9);
}

TEST(VirtualScanShapes, Box_EveryPointLiesOnAFace) {
    const VirtualScanResult result = scan(shape_of(Shape::box, {2.0, 3.0, 4.0}, 0.05));
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        const Vec3 scaled = result.points.positions[i].cwiseQuotient(Vec3(1, 1.5, 2));
        ASSERT_LE(scaled.cwiseAbs().maxCoeff(), 1 + 1e-12);
        ASSERT_NEAR(scaled.dot(normal_of(result.points, i)), 1, 1e-12) << "the normal names the face";
    }
}

/// Cauchy: the mean projected area of a convex body is a quarter of its surface.
TEST(VirtualScanShapes, BoxFromManyViews_ShowsAQuarterOfItsSurface) {
    VirtualScanParams params = shape_of(Shape::box, {2.0, 3.0, 4.0}, 0.05);
    params.views = {300};
    const double mean = static_cast<double>(scan(params).points.size()) * 0.05 * 0.05 / 300;
    EXPECT_NEAR(mean, 2 * (6 + 8 + 12) / 4.0, 0.005 * 13);
}

TEST(VirtualScanShapes, CylinderFromManyViews_ShowsAQuarterOfItsSurface) {
    VirtualScanParams params = shape_of(Shape::cylinder, {1.0, 3.0}, 0.04);
    params.views = {300};
    const VirtualScanResult result = scan(params);
    const double surface = 2 * pi * 3 + 2 * pi;
    EXPECT_NEAR(static_cast<double>(result.points.size()) * 0.04 * 0.04 / 300, surface / 4, 0.005 * surface / 4);
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        const Vec3& p = result.points.positions[i];
        const Vec3 normal = normal_of(result.points, i);
        const double ring = std::hypot(p.x(), p.y());
        if (normal.z() == 0) {
            ASSERT_NEAR(ring, 1, 1e-12);
            ASSERT_LE(std::abs(p.z()), 1.5 + 1e-12);
            ASSERT_NEAR(normal.dot(p), 1, 1e-12);
        } else {
            ASSERT_LE(ring, 1 + 1e-12);
            ASSERT_EQ(p.z(), normal.z() * 1.5);
        }
    }
}

TEST(VirtualScanShapes, LBlockFromAbove_ShowsThreeSquares) {
    VirtualScanParams params = shape_of(Shape::l_block, {1.0, 0.5}, 0.01);
    params.views = {0, 0, 1};
    const VirtualScanResult result = scan(params);
    EXPECT_EQ(result.points.size(), 30000u);
    for (const Vec3& p : result.points.positions) {
        ASSERT_EQ(p.z(), 0.5);
        ASSERT_FALSE(p.x() > 1 && p.y() > 1);
    }
}

TEST(VirtualScanShapes, LBlockFromOneSide_HidesPartOfItsInnerWall) {
    VirtualScanParams params = shape_of(Shape::l_block, {1.0, 1.0}, 0.02);
    // From a point (1, y, z) of the inner wall x = 1, the way to the sensor crosses the plane y = 1 at
    // (1 + 2 (y − 1), 1, z + (y − 1) / 2): for y < 3/2 through the arm along x, unless it passes above.
    params.views = {2, -1, 0.5};
    int seen = 0;
    for (const Vec3& p : scan(params).points.positions) {
        if (std::abs(p.x() - 1) > 1e-9 || p.y() < 1 + 1e-9) continue;
        ++seen;
        if (p.y() < 1.5) {
            ASSERT_GT(p.z() + (p.y() - 1) / 2, 1 - 1e-9) << p.transpose();
        }
    }
    // This leaves 1/2 + 1/16 of the wall's area of 1; a ray covers 0.02² / cos of its wall's angle, cos = 2 / √5.25.
    EXPECT_NEAR(seen * 0.0004 / (2 / std::sqrt(5.25)), 0.5625, 0.02);
}

TEST(VirtualScanShapes, DefaultSizes_AreTheDocumentedOnes) {
    VirtualScanParams params;
    params.shape = Shape::torus;
    for (const Vec3& p : scan(params).points.positions)
        ASSERT_NEAR(std::hypot(std::hypot(p.x(), p.y()) - 1, p.z()), 0.4, 1e-9);
}

TEST(VirtualScanShapes, SignChanges_OfAQuarticWithKnownRoots_AreFound) {
    // (x − 1)(x − 2)(x − 3)(x + 4) = x⁴ − 2 x³ − 13 x² + 38 x − 24
    const auto roots = scan::sign_changes(std::array<double, 5>{-24, 38, -13, -2, 1}, -10.0, 10.0, 1e-12);
    ASSERT_EQ(roots.size(), 4u);
    const double expected[] = {-4, 1, 2, 3};
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(roots[i], expected[i], 1e-11);
    EXPECT_EQ(scan::sign_changes(std::array<double, 5>{-24, 38, -13, -2, 1}, 0.0, 2.5, 1e-12).size(), 2u);
    EXPECT_TRUE(scan::sign_changes(std::array<double, 3>{1, 0, 1}, -10.0, 10.0, 1e-12).empty());
}

/// On the slope of a cone of this radius and height over z = 0, with its apex on the side of `up`.
Vec3 slope_normal(const Vec3& p, double radius, double height, double up) {
    return Vec3(p.x() * height, p.y() * height, up * radius * std::hypot(p.x(), p.y())).normalized();
}

TEST(VirtualScanShapes, Bicone_EveryPointLiesOnItWithItsNormal) {
    const double radius = 3, height = 2;
    VirtualScanParams params = shape_of(Shape::bicone, {radius, height}, 0.03);
    params.views = {40};
    const VirtualScanResult result = scan(params);
    ASSERT_GT(result.points.size(), 100000u);
    double farthest = 0;
    for (const Vec3& p : result.points.positions) {
        ASSERT_NEAR(std::hypot(p.x(), p.y()) / radius + std::abs(p.z()) / height, 1, 1e-9);
        farthest = std::max(farthest, std::hypot(p.x(), p.y()));
    }
    EXPECT_GT(farthest, radius - 0.01) << "the edge is sharp";
    expect_normals(
        result, [&](const Vec3& p) { return slope_normal(p, radius, height, p.z() >= 0 ? 1 : -1); }, 1e-5);
}

TEST(VirtualScanShapes, BiconeFromTheSide_ShowsItsLozenge) {
    VirtualScanParams params = shape_of(Shape::bicone, {3.0, 2.0}, 0.01);
    params.views = {1, 0, 0, 0, 0, 1, 1, 2, 0.5};
    const VirtualScanResult result = scan(params);
    EXPECT_NEAR(static_cast<double>(points_of_view(result.points, 0)) * 1e-4, 12, 0.02);
    EXPECT_NEAR(static_cast<double>(points_of_view(result.points, 1)) * 1e-4, 9 * pi, 0.02);
    for (const Vec3& p : result.points.positions) ASSERT_GE(p.dot(Vec3(0, 0, 1)), -2 - 1e-9);
}

TEST(VirtualScanShapes, ConeOnHemisphere_EveryPointLiesOnItWithItsNormal) {
    const double radius = 3, height = 1.5;
    VirtualScanParams params = shape_of(Shape::cone_on_hemisphere, {radius, height}, 0.03);
    params.views = {40};
    const VirtualScanResult result = scan(params);
    ASSERT_GT(result.points.size(), 100000u);
    std::size_t above = 0;
    for (const Vec3& p : result.points.positions) {
        if (p.z() > 0) {
            ASSERT_NEAR(std::hypot(p.x(), p.y()) / radius + p.z() / height, 1, 1e-9);
            ++above;
        } else {
            ASSERT_NEAR(p.norm(), radius, 1e-9);
        }
    }
    EXPECT_GT(above, result.points.size() / 5);
    expect_normals(
        result, [&](const Vec3& p) { return p.z() > 0 ? slope_normal(p, radius, height, 1) : Vec3(p / radius); }, 1e-5);
}

TEST(VirtualScanShapes, RaysAtTheCircularEdge_DoNotPassThroughTheBody) {
    // The box of the second shape is not symmetric: a row of its rays lies in the plane of the edge.
    for (const Shape shape : {Shape::bicone, Shape::cone_on_hemisphere}) {
        VirtualScanParams params = shape_of(shape, {1.0, 0.83}, 0.01);
        params.views = {1, 0, 0};
        const VirtualScanResult result = scan(params);
        for (const Vec3& p : result.points.positions) ASSERT_GE(p.x(), -1e-9) << "seen from inside";
        const double silhouette = shape == Shape::bicone ? 2 * 0.83 : 0.83 + pi / 2;
        EXPECT_NEAR(static_cast<double>(result.points.size()) * 1e-4, silhouette, 0.005);
    }
}

}  // namespace
}  // namespace scanmill::test
