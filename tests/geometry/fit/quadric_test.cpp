// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/fit/quadric.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "scanmill/base/random.hpp"

namespace scanmill {
namespace {

std::vector<QuadricSample> samples_of(const Quadric& quadric, int count, std::uint64_t seed) {
    Random random(seed);
    std::vector<QuadricSample> samples;
    for (int i = 0; i < count; ++i) {
        const double u = random.uniform(-1, 1), v = random.uniform(-1, 1);
        samples.push_back({u, v, quadric.at(u, v), random.uniform(0.5, 2)});
    }
    return samples;
}

/// From the first and second fundamental forms of the graph at the origin.
PrincipalCurvatures by_fundamental_forms(const Quadric& q) {
    const double w = std::sqrt(1 + q.d * q.d + q.e * q.e);
    const double E = 1 + q.d * q.d, F = q.d * q.e, G = 1 + q.e * q.e;
    const double L = 2 * q.a / w, M = q.b / w, N = 2 * q.c / w;
    const double gaussian = (L * N - M * M) / (E * G - F * F);
    const double mean = (E * N - 2 * F * M + G * L) / (2 * (E * G - F * F));
    const double root = std::sqrt(std::max(0.0, mean * mean - gaussian));
    return mean >= 0 ? PrincipalCurvatures{mean + root, mean - root} : PrincipalCurvatures{mean - root, mean + root};
}

TEST(Quadric, SampledExactly_IsRecovered) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Random random(seed + 100);
        const auto any = [&] { return random.uniform(-2, 2); };
        const Quadric quadric{any(), any(), any(), any(), any()};
        for (const int count : {6, 25}) {
            const std::optional<Quadric> fitted = fit_quadric(samples_of(quadric, count, seed));
            ASSERT_TRUE(fitted) << seed;
            const double tolerance = count == 6 ? 1e-9 : 1e-12;  // six points may lie near a conic
            EXPECT_NEAR(fitted->a, quadric.a, tolerance) << seed;
            EXPECT_NEAR(fitted->b, quadric.b, tolerance);
            EXPECT_NEAR(fitted->c, quadric.c, tolerance);
            EXPECT_NEAR(fitted->d, quadric.d, tolerance);
            EXPECT_NEAR(fitted->e, quadric.e, tolerance);
        }
    }
}

TEST(Quadric, WithoutInclination_HasNone) {
    const std::optional<Quadric> same = fit_quadric(samples_of({1, -2, 3, 0, 0}, 9, 1), Inclination::none);
    ASSERT_TRUE(same);
    EXPECT_NEAR(same->a, 1, 1e-12);
    EXPECT_NEAR(same->b, -2, 1e-12);
    EXPECT_NEAR(same->c, 3, 1e-12);
    const std::vector<QuadricSample> uneven{{1, 0, 2}, {-1, 0, 1}, {0, 1, 0}, {1, 1, 1.5}, {-1, -1, 1.5}};
    const std::optional<Quadric> fitted = fit_quadric(uneven, Inclination::none);
    ASSERT_TRUE(fitted);
    EXPECT_NEAR(fitted->a, 1.5, 1e-14);
    EXPECT_NEAR(fitted->b, 0, 1e-14);
    EXPECT_NEAR(fitted->c, 0, 1e-14);
    EXPECT_EQ(fitted->d, 0);
    EXPECT_FALSE(fit_quadric(std::vector<QuadricSample>{{1, 0, 2}, {-1, 0, 1}, {0.5, 0, 0}}, Inclination::none));
}

/// By hand: at u = 1 with weights 1 and 3 between heights 0 and 4 lies 3; all other samples agree with s = 3 u².
TEST(Quadric, ContradictingSamples_CountByTheirWeights) {
    std::vector<QuadricSample> samples;
    for (const double v : {-1.0, 0.0, 1.0}) {
        samples.push_back({-1, v, 3, 1});
        samples.push_back({0, v, 0, 1});
        samples.push_back({1, v, 4, 3});
        samples.push_back({1, v, 0, 1});
    }
    const std::optional<Quadric> fitted = fit_quadric(samples);
    ASSERT_TRUE(fitted);
    EXPECT_NEAR(fitted->a, 3, 1e-14);
    EXPECT_NEAR(fitted->b, 0, 1e-14);
    EXPECT_NEAR(fitted->c, 0, 1e-14);
    EXPECT_NEAR(fitted->d, 0, 1e-14);
}

TEST(Quadric, SamplesOnALineOrTwo_DetermineNone) {
    std::vector<QuadricSample> line, two_lines;
    for (int i = -6; i <= 6; ++i) {
        if (i == 0) continue;
        const double u = i / 6.0;
        line.push_back({u, 0.5 * u, u * u});
        two_lines.push_back({u, 0, u * u});
        two_lines.push_back({u, 0.5, u * u});
    }
    EXPECT_FALSE(fit_quadric(line));
    EXPECT_FALSE(fit_quadric(two_lines));
    two_lines.push_back({0, 1, 0});
    EXPECT_TRUE(fit_quadric(two_lines)) << "a third line distinguishes v from v²";
    EXPECT_FALSE(fit_quadric(std::vector<QuadricSample>(4, {1, 1, 1})));
}

TEST(PrincipalCurvatures, WithoutGradient_AreThoseOfTheCoefficients) {
    const PrincipalCurvatures saddle = principal_curvatures({1, 0, -3, 0, 0});
    EXPECT_EQ(saddle.first, -6);
    EXPECT_EQ(saddle.second, 2);
    const PrincipalCurvatures turned = principal_curvatures({1, 4, 1, 0, 0});  // 2 ± 4
    EXPECT_DOUBLE_EQ(turned.first, 6);
    EXPECT_DOUBLE_EQ(turned.second, -2);
}

/// The lower half of the unit sphere, s = 1 - sqrt(1 - x²), seen from planes that are not tangent: both curvatures are
/// 1. By Taylor's series around x = 0.6, where the slope is 3/4: s'' = 1 / 0.8³ along, (slope / x) across.
TEST(PrincipalCurvatures, OfAnInclinedSphere_AreOne) {
    const double along = 1 / (0.8 * 0.8 * 0.8), across = 1 / 0.8;
    for (const double angle : {0.0, 0.4, 1.5707963267948966, 3.0}) {
        const double x = std::cos(angle), y = std::sin(angle);
        const Quadric quadric{(along * x * x + across * y * y) / 2, (along - across) * x * y,
                              (along * y * y + across * x * x) / 2, 0.75 * x, 0.75 * y};
        EXPECT_NEAR(principal_curvatures(quadric).first, 1, 1e-14) << angle;
        EXPECT_NEAR(principal_curvatures(quadric).second, 1, 1e-14) << angle;
    }
}

TEST(PrincipalCurvatures, OfAnyQuadric_AreThoseOfTheFundamentalForms) {
    Random random(3);
    const auto any = [&] { return random.uniform(-2, 2); };
    for (int i = 0; i < 1000; ++i) {
        const Quadric quadric{any(), any(), any(), any(), any()};
        const PrincipalCurvatures expected = by_fundamental_forms(quadric), found = principal_curvatures(quadric);
        EXPECT_NEAR(found.first, expected.first, 1e-6);  // the forms' root of a difference loses half the digits
        EXPECT_NEAR(found.second, expected.second, 1e-6);
    }
}

}  // namespace
}  // namespace scanmill
