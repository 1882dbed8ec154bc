// SPDX-License-Identifier: GPL-3.0-or-later
/// The plane perpendicular to an edge: closed forms against a swept circle, and the numbers of Wang 2006.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "filters/probe_planner/cases.hpp"
#include "probe_planner/contact_range.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill::probing {
namespace {

constexpr double pi = std::numbers::pi, degree = pi / 180;

using test::lead_of_edge;
using test::Wedge;

Vec2 at(double t, double theta) { return {t * std::sin(theta), t * std::cos(theta)}; }

/// |phi - beta| and its limit.
double margin(const Wedge& wedge, double phi, const Vec2& t) {
    const double d = t.x() * std::cos(phi) + t.y() * std::sin(phi);
    return pi / 2 - wedge.alpha / 2 - std::abs(phi - std::asin(d / wedge.radius));
}

TEST(EdgeFirst, OnTenThousandRandomWedges_AgreesWithASweptCircle) {
    Random random(1);
    int met = 0, missed = 0, borders = 0;
    for (int i = 0; i < 10000; ++i) {
        const Wedge wedge{random.uniform(11, 177) * degree, std::pow(10, random.uniform(-2, 2))};
        const Vec2 t = at(random.uniform(0, 0.98) * wedge.radius, random.uniform(0, 2 * pi));
        const double phi = random.uniform(-89, 89) * degree;
        if (std::abs(margin(wedge, phi, t)) < 1e-9) {
            ++borders;
            continue;
        }
        const bool expected = lead_of_edge(wedge, phi, t) > 0;
        EXPECT_EQ(EdgeFirst(wedge.alpha, wedge.radius, phi)(t), expected)
            << "alpha " << wedge.alpha / degree << " phi " << phi / degree << " t " << t.transpose();
        (expected ? met : missed) += 1;
    }
    EXPECT_GT(met, 2000);
    EXPECT_GT(missed, 2000);
    EXPECT_LT(borders, 3);
}

TEST(EdgeFirst, OfTheLeftFaceAlone_IsTheClosedForm) {
    Random random(2);
    for (int i = 0; i < 10000; ++i) {
        const Wedge wedge{random.uniform(11, 177) * degree, 2};
        const double t = random.uniform(0, 1.9), theta = random.uniform(0, 2 * pi),
                     phi = random.uniform(0, 80) * degree;
        // With phi >= 0 and T on the side of the left face, only that face can be met first.
        if (t * std::sin(theta + phi) > 0) continue;
        const double criterion = t * std::sin(theta + phi) + wedge.radius * std::cos(phi + wedge.alpha / 2);
        if (std::abs(criterion) < 1e-9) continue;
        EXPECT_EQ(EdgeFirst(wedge.alpha, wedge.radius, phi)(at(t, theta)), criterion > 0);
    }
}

TEST(EdgeFirst, AtTheEnds_HasNoSingularity) {
    for (const double alpha : {1.0, 30.0, 90.0, 150.0, 179.0}) {
        for (const double phi : {-90.0, -1e-300, 0.0, 1e-300, 90.0}) {
            const EdgeFirst edge_first(alpha * degree, 2, phi * degree);
            EXPECT_EQ(edge_first(Vec2::Zero()), std::abs(phi) <= 90 - alpha / 2) << alpha << ' ' << phi;
        }
        // At phi = 0 a point beside the edge is on the border where it is as far as the face's normal reaches.
        const EdgeFirst straight(alpha * degree, 2, 0);
        const double limit = 2 * std::cos(alpha / 2 * degree);
        EXPECT_TRUE(straight(Vec2(limit * (1 - 1e-12), 0.3)));
        EXPECT_FALSE(straight(Vec2(limit * (1 + 1e-12), 0.3)));
    }
}

TEST(RangeOfDisc, ThesisCases_AreAsRecomputed) {
    const auto half_range = [](double alpha) { return range_of_disc(alpha, 5, 0.2).max / degree; };
    const struct {
        double height, half;
    } bicones[] = {{150, 31.40}, {120, 37.51}, {100, 42.71}, {80, 49.05}, {60, 56.74}},
      cones[] = {{20, 37.05}, {50, 29.43}, {70, 25.21}, {100, 20.21}};
    for (const auto& [height, half] : bicones) EXPECT_NEAR(half_range(2 * std::atan(height / 100)), half, 0.0051);
    for (const auto& [height, half] : cones) EXPECT_NEAR(half_range(pi / 2 + std::atan(height / 100)), half, 0.0051);
    EXPECT_NEAR(std::acos(0.2 / 5) / degree, 87.708, 0.0005);
    EXPECT_NEAR(range_of_disc(90 * degree, 2, 0.72).max / degree, 23.9, 0.06);
    EXPECT_NEAR(range_of_disc(90 * degree, 2, 1).max / degree, 15, 1e-9);
    EXPECT_TRUE(is_empty(range_of_disc(90 * degree, 2, 1.42)));
    EXPECT_NEAR(range_of_disc(90 * degree, 2, 0.5).max / degree, 30.522, 0.0005);
}

TEST(RangeOfDisc, WithoutError_LeavesTheWedge) {
    for (const double alpha : {1.0, 60.0, 90.0, 179.0})
        EXPECT_NEAR(range_of_disc(alpha * degree, 3, 0).max, pi / 2 - alpha / 2 * degree, 1e-15);
    EXPECT_TRUE(is_empty(range_of_disc(60 * degree, 3, 3))) << "an error as large as the ball leaves nothing";
    EXPECT_TRUE(is_empty(range_of_disc(60 * degree, 3, 3 * (1 - 1e-9))));
    EXPECT_FALSE(is_empty(range_of_disc(60 * degree, 2, std::sqrt(3)))) << "a single direction is not empty";
}

TEST(RangeOfDisc, IsNested) {
    for (double alpha = 5; alpha < 180; alpha += 5)
        for (double error = 0; error < 2; error += 0.1) {
            const AngleRange range = range_of_disc(alpha * degree, 2, error),
                             larger_error = range_of_disc(alpha * degree, 2, error + 0.05),
                             larger_ball = range_of_disc(alpha * degree, 2.1, error);
            if (is_empty(larger_error)) continue;
            EXPECT_LT(larger_error.max, range.max);
            if (error > 0)
                EXPECT_GT(larger_ball.max, range.max);
            else
                EXPECT_EQ(larger_ball.max, range.max);
        }
}

TEST(RangeOfPosition, KnownCases) {
    const Vec2 on_face = on_left_face(90 * degree, 0.5);
    const AngleRange range = range_of_position(90 * degree, 2, on_face);
    EXPECT_NEAR(range.min / degree, -45, 1e-12);
    EXPECT_NEAR(range.max / degree, 30.964, 0.0005);
    EXPECT_NEAR(range.max, pi / 4 - std::atan(0.25), 1e-15);
    const AngleRange inside = range_of_position(90 * degree, 2, Vec2(0, -0.5));
    EXPECT_NEAR(inside.max / degree, 36.457, 0.0005);
    EXPECT_EQ(inside.min, -inside.max);
}

TEST(RangeOfPosition, ItsEnds_AreOnTheBorder) {
    Random random(3);
    for (int i = 0; i < 10000; ++i) {
        const Wedge wedge{random.uniform(11, 177) * degree, 2};
        const Vec2 t = at(random.uniform(0, 1.95), random.uniform(0, 2 * pi));
        const AngleRange range = range_of_position(wedge.alpha, wedge.radius, t);
        for (const double phi : {range.min, range.max})
            if (std::abs(phi) < pi / 2) {
                EXPECT_NEAR(margin(wedge, phi, t), 0, 1e-12 / std::cos(1.55)) << i;
            }
        // Nearly everywhere far better than that, which asin near 1 needs.
    }
}

TEST(RangeOfPosition, OverAllPositions_HasTheDiscsRangeInCommon) {
    for (const double alpha : {20.0, 60.0, 90.0, 120.0})
        for (const double t : {0.0, 0.1, 0.5, 0.8}) {
            double low = -pi, high = pi;
            const AngleRange disc = range_of_disc(alpha * degree, 2, t);
            // The worst positions are those across the ends of the range.
            for (int step = 0; step < 3600; ++step) {
                const AngleRange range = range_of_position(alpha * degree, 2, at(t, step * pi / 1800));
                low = std::max(low, range.min);
                high = std::min(high, range.max);
            }
            EXPECT_GE(high, disc.max - 1e-9);
            const AngleRange worst = range_of_position(alpha * degree, 2, at(t, -pi / 2 - disc.max));
            EXPECT_NEAR(worst.max, disc.max, 1e-9);
            EXPECT_NEAR(std::min(high, worst.max), disc.max, 1e-9);
            EXPECT_NEAR(std::max(low, -worst.max), disc.min, 1e-9);
        }
}

TEST(RangeOnLeftFace, LeansTowardsTheRightNormal_AndIsWider) {
    EXPECT_NEAR(range_on_left_face(90 * degree, 2, 1.94, 0).min / degree, -45, 1e-12);
    EXPECT_NEAR(range_on_left_face(90 * degree, 2, 1.94, 0).max / degree, 0.87, 0.005);
    for (const double error : {0.0, 0.3, 1.0, 1.9}) {
        const AngleRange face = range_on_left_face(90 * degree, 2, error, 0),
                         disc = range_of_disc(90 * degree, 2, error);
        if (!is_empty(disc)) {
            EXPECT_LE(face.min, disc.min + 1e-15);
            EXPECT_GE(face.max, disc.max - 1e-15);
        }
    }
}

TEST(RangeOnLeftFace, IsExactlyWhatAllItsPositionsHaveInCommon) {
    Random random(4);
    for (const double alpha : {50 * degree, 90 * degree, 130 * degree})
        for (const auto& [error, beyond] :
             {std::pair(0.0, 0.4), std::pair(0.3, 0.2), std::pair(0.2, 0.5), std::pair(1.5, 0.2)}) {
            const AngleRange range = range_on_left_face(alpha, 2, error, beyond);
            if (is_empty(range)) continue;
            for (int i = 0; i < 1000; ++i) {
                const double s = random.uniform(-beyond, error), phi = random.uniform(range.min, range.max);
                EXPECT_TRUE(EdgeFirst(alpha, 2, phi)(on_left_face(alpha, s))) << s << ' ' << phi / degree;
            }
            for (const double phi : {range.min - 1e-6, range.max + 1e-6}) {
                const EdgeFirst edge_first(alpha, 2, phi);
                EXPECT_FALSE(edge_first(on_left_face(alpha, error)) && edge_first(on_left_face(alpha, -beyond)))
                    << alpha / degree << ' ' << error << ' ' << beyond << ' ' << phi / degree;
            }
        }
}

/// The exact share of the disc of radius delta for which the nearer face is met first.
double share_of_false_touches(double alpha, double radius, double delta, double phi) {
    const double x = radius * std::cos(std::abs(phi) + alpha / 2) / delta;
    return x >= 1 ? 0 : (std::acos(x) - x * std::sqrt(1 - x * x)) / pi;
}

TEST(EdgeFirst, ShareOfPositionsInTheDisc_IsTheExactOne) {
    EXPECT_EQ(share_of_false_touches(90 * degree, 2, 0.75, 22 * degree), 0);
    EXPECT_NEAR(share_of_false_touches(90 * degree, 2, 0.75, 30 * degree), 0.0986, 0.00005);
    EXPECT_NEAR(share_of_false_touches(90 * degree, 2, 0.75, 40 * degree), 0.353, 0.0005);
    EXPECT_NEAR(share_of_false_touches(90 * degree, 2, 0.75, 50 * degree), 0.647, 0.0005);
    Random random(5);
    for (const double phi : {0.0, 22.0, -22.0, 30.0, -30.0, 40.0, 50.0}) {
        const EdgeFirst edge_first(90 * degree, 2, phi * degree);
        constexpr int count = 100000;
        int missed = 0;
        for (int i = 0; i < count; ++i)
            missed += !edge_first(at(0.75 * std::sqrt(random.uniform()), random.uniform(0, 2 * pi)));
        const double share = share_of_false_touches(90 * degree, 2, 0.75, phi * degree);
        EXPECT_NEAR(missed / double(count), share, 3 * std::sqrt(share * (1 - share) / count)) << phi;
    }
}

}  // namespace
}  // namespace scanmill::probing
