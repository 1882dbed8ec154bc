// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/fit/local_surface.hpp"

#include "scanmill/filter/context.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "scanmill/base/random.hpp"
#include "scanmill/geometry/fit/covariance.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using Origin = LocalSurfaceParams::Origin;

Array<LocalSurface> surfaces_of(const PointTree& tree, Origin origin = Origin::centroid, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return local_surfaces(tree, {25, origin}, context);
}

/// (u, v, height) for a grid of 7 × 7, turned.
template <class Height>
PointCloud graph(double step, Height&& height) {
    Array<Vec3> points;
    for (int i = -3; i <= 3; ++i)
        for (int j = -3; j <= 3; ++j) points.push_back(Vec3(i * step, j * step, height(i * step, j * step)));
    return test::rotated({{}, std::move(points), {}}, 0.7);
}

TEST(LocalSurface, OnASphere_BothCurvaturesAreOneOverItsRadius) {
    const double radius = 8;
    const PointCloud sphere = test::moved(test::fibonacci_sphere(3000), radius);  // spacing about radius / 15
    for (const Origin origin : {Origin::nearest, Origin::centroid}) {
        // Where neighbours are spread unevenly the plane is not tangent, as `nearest` takes it to be.
        const double tolerance = (origin == Origin::nearest ? 0.12 : 0.03) / radius;
        const PointTree tree(sphere.positions.span());
        const Array<LocalSurface> surfaces = surfaces_of(tree, origin);
        for (std::size_t i = 0; i < surfaces.size(); ++i) {
            ASSERT_TRUE(surfaces[i].is_curved);
            EXPECT_NEAR(std::abs(surfaces[i].first_curvature), 1 / radius, tolerance);
            EXPECT_NEAR(std::abs(surfaces[i].second_curvature), 1 / radius, tolerance);
            // Within the distance that the origin may have from the point.
            const Vec3 outwards = tree.positions()[i].normalized();
            EXPECT_GT(std::abs(surfaces[i].normal.dot(outwards)), 0.97);
            EXPECT_LT(surfaces[i].first_curvature * surfaces[i].normal.dot(outwards), 0) << "bends away from outside";
        }
    }
}

TEST(LocalSurface, OnAPlane_NothingBends) {
    const PointCloud plane = graph(0.1, [](double u, double v) { return 0.3 * u - 0.2 * v; });
    const PointTree tree(plane.positions.span());
    const auto& p = plane.positions;
    const Vec3 normal = with_positive_sign((p[1] - p[0]).cross(p[p.size() - 1] - p[0]).normalized());
    for (const LocalSurface& surface : surfaces_of(tree)) {
        EXPECT_TRUE(surface.is_curved) << "a quadric is determined: it is flat";
        EXPECT_LT(std::abs(surface.first_curvature), 1e-9);
        EXPECT_LT(surface.fit_error, 1e-15);
        EXPECT_NEAR(surface.normal.dot(normal), 1, 1e-12);
    }
}

TEST(LocalSurface, OfACylinderAndASaddle_CurvaturesDifferInSizeAndSign) {
    const double step = 0.01;
    const auto middle = [&](const PointCloud& cloud) {
        std::vector<Vec3> others(cloud.positions.begin(), cloud.positions.end());
        others.erase(others.begin() + 24);
        return local_surface(cloud.positions[24], others, Origin::nearest);
    };
    const LocalSurface cylinder = middle(graph(step, [](double u, double) { return 1 - std::sqrt(1 - u * u); }));
    EXPECT_NEAR(std::abs(cylinder.first_curvature), 1, 1e-3);
    EXPECT_NEAR(cylinder.second_curvature, 0, 1e-3);
    const LocalSurface saddle = middle(graph(step, [](double u, double v) { return u * u - 2 * v * v; }));
    EXPECT_NEAR(std::abs(saddle.first_curvature), 4, 1e-2);
    EXPECT_NEAR(std::abs(saddle.second_curvature), 2, 1e-2);
    EXPECT_LT(saddle.first_curvature * saddle.second_curvature, 0);
}

TEST(LocalSurface, ScaledByAPowerOfTwo_IsScaledExactly) {
    const PointCloud sphere = test::fibonacci_sphere(500, 0.003);
    const Array<LocalSurface> plain = surfaces_of(PointTree(sphere.positions.span()));
    for (const int exponent : {-30, 30}) {
        const PointCloud scaled = test::moved(sphere, std::ldexp(1, exponent));
        const Array<LocalSurface> other = surfaces_of(PointTree(scaled.positions.span()));
        for (std::size_t i = 0; i < plain.size(); ++i) {
            ASSERT_EQ(other[i].first_curvature, std::ldexp(plain[i].first_curvature, -exponent)) << i;
            ASSERT_EQ(other[i].second_curvature, std::ldexp(plain[i].second_curvature, -exponent));
            ASSERT_EQ(other[i].fit_error, std::ldexp(plain[i].fit_error, exponent));
            ASSERT_EQ(other[i].spacing, std::ldexp(plain[i].spacing, exponent));
            ASSERT_EQ(other[i].normal, plain[i].normal);
        }
    }
}

TEST(LocalSurface, OnePointFarOff_IsLeftOutOfTheFit) {
    PointCloud paraboloid = graph(0.1, [](double u, double v) { return u * u + v * v; });
    const Vec3 apex = paraboloid.positions[24];
    std::vector<Vec3> neighbours;
    for (const Vec3& p : paraboloid.positions)
        if (p != apex) neighbours.push_back(p);
    const Vec3 normal = local_surface(apex, neighbours, Origin::centroid).normal;
    neighbours[5] += 0.03 * normal;
    const LocalSurface surface = local_surface(apex, neighbours, Origin::centroid);
    EXPECT_EQ(surface.outliers, 1u);
    EXPECT_NEAR(std::abs(surface.first_curvature), 2, 1e-3);
    EXPECT_NEAR(std::abs(surface.second_curvature), 2, 1e-3);
    EXPECT_NEAR(surface.fit_error, 0.03 / 48, 0.001) << "it still counts in the error";
}

TEST(LocalSurface, PointsNearALine_ShowNone) {
    const PointTree line(
        test::cloud_of({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}, {5, 5, 5}, {6, 6, 6.01}})
            .positions.span());
    for (const LocalSurface& surface : surfaces_of(line)) {
        EXPECT_FALSE(surface.is_curved);
        EXPECT_EQ(surface.first_curvature, 0);
        EXPECT_NEAR(surface.normal.norm(), 1, 1e-12);
        EXPECT_NEAR(surface.normal.dot(Vec3(1, 1, 1)), 0, 0.01);
    }
}

TEST(LocalSurface, FewPoints_MakeAPlaneAndTheirDistancesFromIt) {
    const PointCloud cross = test::cloud_of({{4, 0, 1}, {-4, 0, 1}, {0, 4, -1}, {0, -4, -1}, {0, 0, 0}});
    const PointTree tree(cross.positions.span());
    const LocalSurface centre = surfaces_of(tree)[tree.index_of_row()[4]];
    EXPECT_FALSE(centre.is_curved);
    EXPECT_DOUBLE_EQ(centre.fit_error, 1);
    EXPECT_EQ(centre.normal, Vec3(0, 0, 1));
    EXPECT_DOUBLE_EQ(centre.spacing, std::sqrt(17));
    const Vec3 alone(1, 2, 3);
    const LocalSurface one = surfaces_of(PointTree(std::span(&alone, 1)))[0];
    EXPECT_EQ(one.normal, Vec3(0, 0, 1));
    EXPECT_EQ(one.fit_error, 0);
}

/// At the boundary of a hemisphere all neighbours lie on one side of the point.
TEST(LocalSurface, OriginNearTheCentroid_FitsBetterAtARim) {
    Array<Vec3> half;
    for (const Vec3& p : test::fibonacci_sphere(2600).positions)
        if (p.z() >= 0) half.push_back(8 * p);
    const PointTree tree(half);
    const Array<LocalSurface> nearest = surfaces_of(tree, Origin::nearest), centroid = surfaces_of(tree);
    double nearest_sum = 0, centroid_sum = 0;
    for (std::size_t i = 0; i < nearest.size(); ++i)
        if (tree.positions()[i].z() < 0.5) nearest_sum += nearest[i].fit_error, centroid_sum += centroid[i].fit_error;
    EXPECT_LT(centroid_sum, 0.9 * nearest_sum);
}

TEST(LocalSurface, TwoThreads_FindTheSame) {
    const PointTree tree(test::random_sphere(20'000, 1).positions.span());
    const Array<LocalSurface> one = surfaces_of(tree, Origin::centroid, 1),
                              two = surfaces_of(tree, Origin::centroid, 2);
    for (std::size_t i = 0; i < one.size(); ++i) {
        ASSERT_EQ(one[i].normal, two[i].normal);
        ASSERT_EQ(one[i].first_curvature, two[i].first_curvature);
    }
}

/// The normal of the best plane, for so few points that no quadric is fitted.
Vec3 plane_normal(std::span<const Vec3> points) {
    const LocalSurface surface = local_surface(points[0], points.subspan(1), Origin::centroid);
    EXPECT_FALSE(surface.is_curved);
    return surface.normal;
}

TEST(PlaneNormal, OfPointsInAnyPlane_IsAcrossIt) {
    Random random(1);
    for (int i = 0; i < 200; ++i) {
        const auto any = [&] { return random.uniform(-1, 1); };
        const Vec3 u(any(), any(), any()), v(any(), any(), any());
        const Vec3 far(1000 * any(), 1000 * any(), 1000 * any());
        std::vector<Vec3> points;
        for (int k = 0; k < 6; ++k) points.push_back(far + any() * u + any() * v);
        const Vec3 expected = with_positive_sign(u.cross(v).normalized());
        EXPECT_GT(plane_normal(points).dot(expected), 1 - 1e-9) << i;
    }
}

TEST(PlaneNormal, OfSymmetricPoints_ByHand) {
    const std::vector<Vec3> upright{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}};
    EXPECT_EQ(plane_normal(upright), Vec3(1, 0, 0));
    const std::vector<Vec3> axes{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    EXPECT_NEAR(plane_normal(axes).norm(), 1, 1e-12) << "all directions are equal; it is one of them";
}

}  // namespace
}  // namespace scanmill
