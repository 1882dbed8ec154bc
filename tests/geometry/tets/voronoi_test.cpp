// SPDX-License-Identifier: GPL-3.0-or-later
/// The cocone and single Voronoi edges, by hand. Edges of tetrahedralisations are tested with those of 'delaunay', in
/// tests/filters/cocone.

#include "scanmill/geometry/tets/voronoi.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "scanmill/base/random.hpp"
#include "support/numbers.hpp"

namespace scanmill::test {
namespace {

double above_by_one_bit(double x) { return std::nextafter(x, infinity); }

/// An apex in the origin and a vertical axis; a point is in the cocone if z² ≤ squared_sine |y|².
Cocone upright_cocone(double squared_sine) { return {Vec3(0, 0, 0), Vec3(0, 0, 1), squared_sine}; }

/// The points (2, 0, t). With a cocone of 45 degrees, those with |t| ≤ 2 are inside.
VoronoiEdge vertical_edge(double from, double to) { return {Vec3(2, 0, 0), Vec3(0, 0, 1), from, to}; }

TEST(Cone, AnEndOnTheLimit_IsInside) {
    const Cocone cocone = upright_cocone(0.5);
    EXPECT_TRUE(cocone.meets(vertical_edge(2, 5)));
    EXPECT_FALSE(cocone.meets(vertical_edge(above_by_one_bit(2), 5)));
    EXPECT_TRUE(cocone.meets(vertical_edge(-5, -2)));
    EXPECT_FALSE(cocone.meets(vertical_edge(-5, -above_by_one_bit(2))));
    EXPECT_TRUE(cocone.meets(vertical_edge(2, 2))) << "an edge of length 0";
    EXPECT_FALSE(cocone.meets(vertical_edge(3, 3)));
    EXPECT_TRUE(cocone.meets(vertical_edge(2, infinity)));
    EXPECT_FALSE(cocone.meets(vertical_edge(above_by_one_bit(2), infinity)));
}

TEST(Cone, ALevelEdge_MeetsFarFromTheApex) {
    // (1, t, 2) is in the cocone of 45 degrees if 4 ≤ 1 + t².
    const VoronoiEdge level{Vec3(1, 0, 2), Vec3(0, 1, 0), -1, 0};
    EXPECT_FALSE(upright_cocone(0.5).meets(level));
    EXPECT_TRUE(upright_cocone(0.5).meets({level.foot, level.normal, -1, 2}));
    EXPECT_TRUE(upright_cocone(0.5).meets({level.foot, level.normal, -2, 1}));
    EXPECT_TRUE(upright_cocone(0.5).meets({level.foot, level.normal, 0, infinity}));
}

TEST(Cone, AnEdgeThatCrossesItBetweenItsEnds_Meets) {
    EXPECT_TRUE(upright_cocone(0.5).meets(vertical_edge(-5, 5)));
    EXPECT_TRUE(upright_cocone(0.5).meets(vertical_edge(-2000, 5)));
    EXPECT_TRUE(upright_cocone(0.5).meets(vertical_edge(-5, infinity)));
    EXPECT_TRUE(upright_cocone(1e-9).meets(vertical_edge(-5, infinity)));
    EXPECT_TRUE(upright_cocone(0).meets(vertical_edge(-5, infinity))) << "the tangent plane alone";
    EXPECT_FALSE(upright_cocone(0).meets(vertical_edge(1, infinity)));
}

TEST(Cone, ARay_MeetsByItsStartOrItsDirection) {
    const auto ray_from = [](const Vec3& foot) { return VoronoiEdge{foot, Vec3(-0.8, 0, 0.6), 0, infinity}; };
    const Vec3 below(-0.6, 0, -0.8), above(0.6, 0, 0.8), level(0, 1, 0);
    // The sine of the limit is 0.6 like that of the ray's direction, more, or less.
    for (const double sine : {0.6, 0.61, 0.59}) {
        EXPECT_TRUE(upright_cocone(sine * sine).meets(ray_from(below))) << "crosses the tangent plane";
        EXPECT_TRUE(upright_cocone(sine * sine).meets(ray_from(level))) << "starts inside";
    }
    EXPECT_TRUE(upright_cocone(0.61 * 0.61).meets(ray_from(above))) << "ends inside";
    EXPECT_FALSE(upright_cocone(0.59 * 0.59).meets(ray_from(above)));
}

TEST(Cone, AnEdgeWithBothEndsOutsideOnOneSide_DoesNotMeet) {
    // Along a straight edge, the directions from the apex lie on a half of a great circle. There the height over the
    // tangent plane is a cosine, which has no least value above 0. So the edge meets the cocone between its ends
    // exactly if the ends are on different sides.
    Random random(5);
    int crossing = 0, same_side = 0, dived = 0;
    for (int round = 0; round < 100'000; ++round) {
        const Vec3 normal = Vec3(random.normal(), random.normal(), random.normal()).normalized();
        const Vec3 foot = normal.cross(Vec3(random.normal(), random.normal(), random.normal()));
        const double from = 3 * random.normal(), to = from + 6 * random.uniform();
        const Cocone cocone = upright_cocone(random.uniform(0.01, 0.5));
        const Vec3 first = foot + from * normal, last = foot + to * normal;
        const auto is_outside = [&](const Vec3& y) {
            return y.z() * y.z() > (cocone.squared_sine + 1e-9) * y.squaredNorm();
        };
        if (!is_outside(first) || !is_outside(last)) continue;
        const bool crosses = first.z() * last.z() < 0;
        EXPECT_EQ(cocone.meets({foot, normal, from, to}), crosses) << round;
        (crosses ? crossing : same_side)++;
        // The steepness is highest between the ends, so it is not monotone.
        const Vec3 middle = foot + 0.5 * (from + to) * normal;
        dived += !crosses && std::abs(middle.z()) / middle.norm() >
                                 std::max(std::abs(first.z()) / first.norm(), std::abs(last.z()) / last.norm());
    }
    EXPECT_GT(crossing, 5000);
    EXPECT_GT(same_side, 5000);
    EXPECT_GT(dived, 500);
}

TEST(Cone, Reach_IsTheDistanceToTheCrossingOfTheTangentPlane) {
    const Cocone cocone = upright_cocone(0.1);
    EXPECT_EQ(cocone.squared_reach(vertical_edge(-1, 1)), 4);
    EXPECT_EQ(cocone.squared_reach(vertical_edge(0, 1)), 4) << "an end in the plane";
    EXPECT_EQ(cocone.squared_reach(vertical_edge(-1, 0)), 4);
    EXPECT_EQ(cocone.squared_reach(vertical_edge(-1, infinity)), 4);
    EXPECT_EQ(cocone.squared_reach(vertical_edge(0.5, 1)), -1);
    EXPECT_EQ(cocone.squared_reach(vertical_edge(0.5, infinity)), -1);
    EXPECT_EQ(cocone.squared_reach({Vec3(3, 0, 4), Vec3(0, 1, 0), -10, 10}), -1) << "parallel to the plane";
    // (0, 4, 3) + t (0, 0.6, -0.8) reaches z = 0 at t = 3.75, y = 6.25.
    EXPECT_NEAR(cocone.squared_reach({Vec3(0, 4, 3), Vec3(0, 0.6, -0.8), 0, 5}), 6.25 * 6.25, 1e-12);
    EXPECT_EQ(cocone.squared_reach({Vec3(0, 4, 3), Vec3(0, 0.6, -0.8), 0, 3.5}), -1);
}

}  // namespace
}  // namespace scanmill::test
