// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/triangle_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scanmill/base/random.hpp"

namespace scanmill {
namespace {

const Vec3 corner_a(0, 0, 0), corner_b(4, 0, 0), corner_c(0, 4, 0);

TEST(NearestOnTriangle, EveryRegion_ByHand) {
    EXPECT_EQ(nearest_on_triangle({1, 1, 5}, corner_a, corner_b, corner_c), Vec3(1, 1, 0));       // face
    EXPECT_EQ(nearest_on_triangle({-1, -2, 1}, corner_a, corner_b, corner_c), corner_a);  // the three corners
    EXPECT_EQ(nearest_on_triangle({7, -1, 1}, corner_a, corner_b, corner_c), corner_b);
    EXPECT_EQ(nearest_on_triangle({-1, 9, -2}, corner_a, corner_b, corner_c), corner_c);
    EXPECT_EQ(nearest_on_triangle({1, -2, 1}, corner_a, corner_b, corner_c), Vec3(1, 0, 0));  // the three edges
    EXPECT_EQ(nearest_on_triangle({-3, 3, 0}, corner_a, corner_b, corner_c), Vec3(0, 3, 0));
    EXPECT_EQ(nearest_on_triangle({4, 4, 0}, corner_a, corner_b, corner_c), Vec3(2, 2, 0));
}

TEST(NearestOnTriangle, Corners_AreFoundExactly) {
    Random random(3);
    const auto point = [&] { return Vec3(random.uniform(), random.uniform(), random.uniform() + 1000); };
    for (int i = 0; i < 1000; ++i) {
        const Vec3 p = point(), q = point(), r = point();
        EXPECT_EQ(nearest_on_triangle(p, p, q, r), p);
        EXPECT_EQ(nearest_on_triangle(q, p, q, r), q);
        EXPECT_EQ(nearest_on_triangle(r, p, q, r), r);
    }
}

TEST(NearestOnTriangle, CornersOnALine_AreASegment) {
    const Vec3 middle(1, 0, 0);
    EXPECT_EQ(nearest_on_triangle({3, 2, 0}, corner_a, middle, corner_b), Vec3(3, 0, 0));
    EXPECT_EQ(nearest_on_triangle({3, 2, 0}, middle, corner_b, corner_a), Vec3(3, 0, 0));
    EXPECT_EQ(nearest_on_triangle({9, 2, 0}, corner_b, corner_a, middle), corner_b);
    EXPECT_EQ(nearest_on_triangle({3, 2, 0}, corner_a, corner_a, corner_b),
              Vec3(3, 0, 0));  // two equal corners, every way round
    EXPECT_EQ(nearest_on_triangle({3, 2, 0}, corner_a, corner_b, corner_a), Vec3(3, 0, 0));
    EXPECT_EQ(nearest_on_triangle({3, 2, 0}, corner_b, corner_a, corner_a), Vec3(3, 0, 0));
}

TEST(NearestOnTriangle, EqualCorners_AreAPoint) {
    EXPECT_EQ(nearest_on_triangle({3, 2, 1}, corner_b, corner_b, corner_b), corner_b);
}

/// The distance's minimum by ternary search along both sides: slow, and nothing in common with the tested way.
double searched_distance(const Vec3& point, const Vec3& p, const Vec3& q, const Vec3& r) {
    const auto minimum = [](auto&& value) {
        double low = 0, high = 1;
        for (int i = 0; i < 80; ++i) {
            const double left = low + (high - low) / 3, right = high - (high - low) / 3;
            (value(left) < value(right) ? high : low) = value(left) < value(right) ? right : left;
        }
        return value((low + high) / 2);
    };
    return minimum([&](double s) {
        const Vec3 from = p + s * (q - p), to = p + s * (r - p);
        return minimum([&](double t) { return (from + t * (to - from) - point).norm(); });
    });
}

TEST(NearestOnTriangle, RandomTriangles_AgreeWithASearch) {
    Random random(5);
    const auto point = [&] { return Vec3(random.normal(), random.normal(), random.normal()); };
    for (int i = 0; i < 300; ++i) {
        const Vec3 p = point(), q = point(), r = point(), at = 2 * point();
        EXPECT_NEAR((nearest_on_triangle(at, p, q, r) - at).norm(), searched_distance(at, p, q, r), 1e-7);
    }
}

TEST(NearestOnTriangle, ThinTriangles_AgreeWithTheirSegment) {
    // Thinner and thinner: within its height of its longest edge, from whatever corner it is written.
    Random random(7);
    for (double height = 1; height > 1e-16; height /= 10)
        for (int i = 0; i < 50; ++i) {
            const Vec3 p(0, 0, 0), q(1, 0, 0), r(random.uniform(0.1, 0.9), height, 0);
            const Vec3 at(random.uniform(-1, 2), random.uniform(-1, 1), random.uniform(-1, 1));
            const double to_edge = (nearest_on_segment(at, p, q) - at).norm();
            for (double found :
                 {(nearest_on_triangle(at, p, q, r) - at).norm(), (nearest_on_triangle(at, q, r, p) - at).norm(),
                  (nearest_on_triangle(at, r, q, p) - at).norm()}) {
                EXPECT_LE(found, to_edge * (1 + 1e-12));
                EXPECT_GE(found, to_edge - height - 1e-12);
            }
        }
}

TEST(NearestOnTriangle, PointsOnThinTriangles_AreAtZero) {
    // Thinner and thinner, in any direction, from whatever corner they are written.
    Random random(9);
    const auto point = [&]() -> Vec3 { return {random.normal(), random.normal(), random.normal()}; };
    for (double height = 1; height > 1e-17; height /= 10)
        for (int i = 0; i < 300; ++i) {
            const Vec3 p = point(), q = point(), r = p + random.uniform() * (q - p) + height * point();
            const double along = random.uniform(), across = (1 - along) * random.uniform();
            const Vec3 on_edge = p + along * (q - p), inside = on_edge + across * (r - p);
            const double size = (q - p).norm() + (r - p).norm();
            for (const auto& [a1, b1, c1] : {std::array{p, q, r}, std::array{q, r, p}, std::array{r, p, q}}) {
                EXPECT_LE((nearest_on_triangle(on_edge, a1, b1, c1) - on_edge).norm(), 1e-14 * size) << height;
                EXPECT_LE((nearest_on_triangle(inside, a1, b1, c1) - inside).norm(), 1e-14 * size) << height;
            }
        }
}

}  // namespace
}  // namespace scanmill
