// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill {
namespace {

constexpr double pi = std::numbers::pi;

/// Distance between two doubles of equal sign, in units in the last place of the second.
double units_apart(double value, double expected) {
    return std::abs(value - expected) / (std::nextafter(expected, 10) - expected);
}

TEST(AngleOf, IsExactForMultiplesOf45Degrees_AndZeroWithoutDirection) {
    EXPECT_EQ(angle_of(0, 0), 0);
    EXPECT_EQ(angle_of(7, 0), 0);
    EXPECT_EQ(angle_of(3, 3), pi / 4);
    EXPECT_EQ(angle_of(0, 1e-3), pi / 2);
    EXPECT_EQ(angle_of(-5, 5), 3 * pi / 4);
    EXPECT_EQ(angle_of(-1, 0), pi);
}

TEST(AngleOf, AgreesWithTheArctangent_ToAUnitInTheLastPlace) {
    for (int i = 1; i < 100'000; ++i) {
        const double angle = pi * i / 100'000, cosine = std::cos(angle), sine = std::sin(angle);
        ASSERT_LE(units_apart(angle_of(cosine, sine), std::atan2(sine, cosine)), 1) << angle;
    }
}

/// Against the C library's arctangent of long doubles, which is exact to 2^-64 or so.
TEST(AngleOf, IsNearlyAlwaysTheNearestDouble) {
    int others = 0;
    for (int i = -300; i <= 300; ++i)
        for (int j = 1; j <= 300; ++j) {
            const long double exact = std::atan2(static_cast<long double>(j), static_cast<long double>(i));
            others += angle_of(i, j) != static_cast<double>(exact);
        }
    EXPECT_LE(others, 60) << "of 180,300";
}

TEST(AngleOf, KeepsTheDigitsOfSmallAndOfNearlyFlatAngles) {
    for (double sine = 1; sine > 1e-200; sine /= 3) {
        ASSERT_LE(units_apart(angle_of(1, sine), std::atan2(sine, 1)), 1) << sine;
        ASSERT_LE(units_apart(angle_of(-1, sine), std::atan2(sine, -1)), 1) << sine;
    }
}

TEST(AngleOf, DependsOnTheRatioAlone_ForPowersOfTwo) {
    for (const double scale : {0x1p-200, 0x1p-30, 0x1p50, 0x1p200})
        EXPECT_EQ(angle_of(-0.3 * scale, 0.7 * scale), angle_of(-0.3, 0.7));
}

TEST(AngleBetween, IsRightForSmallAndForFlatAngles) {
    for (const double angle : {0.0, 1e-9, 0.5, 3.0, 3.141592652})
        EXPECT_NEAR(angle_between(Vec3(2, 0, 0), Vec3(3 * std::cos(angle), 3 * std::sin(angle), 0)), angle, 1e-15);
    EXPECT_EQ(angle_between(Vec3::Zero(), Vec3(1, 0, 0)), 0);
}

TEST(AnglesBetween, TwoPairs_HaveTheBitsOfEach) {
    std::vector<Vec3> vectors{Vec3::Zero(), Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0)};
    for (int i = 1; i < 40; ++i) vectors.push_back(Vec3(std::sin(7.0 * i), std::sin(11.0 * i), std::sin(13.0 * i)) / i);
    for (std::size_t i = 0; i < vectors.size(); ++i)
        for (std::size_t j = 0; j < vectors.size(); ++j) {
            const Vec3 &a = vectors[i], &b = vectors[j], &c = vectors[vectors.size() - 1 - j];
            const auto [first, second] = angles_between(a, b, c, a);
            ASSERT_EQ(first, angle_between(a, b)) << i << ' ' << j;
            ASSERT_EQ(second, angle_between(c, a)) << i << ' ' << j;
        }
}

}  // namespace
}  // namespace scanmill
