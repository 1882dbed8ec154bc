// SPDX-License-Identifier: GPL-3.0-or-later
/// The references are the C library's functions of long doubles, whose errors are below 2^-62.
#include "scanmill/base/elementary.hpp"

#include <gtest/gtest.h>

#include "scanmill/base/random.hpp"

namespace scanmill {
namespace {

constexpr double pi = std::numbers::pi;

/// In units in the last place of `expected`, which are not below `least`.
double error_of(double value, long double expected, double least = 0) {
    const double magnitude = std::abs(static_cast<double>(expected));
    const double unit = std::nextafter(magnitude, 2 * magnitude + 1) - magnitude;
    return static_cast<double>(std::abs(value - expected)) / std::max(unit, least);
}

TEST(Elementary, Logarithms_AreExactForPowersOfTwo) {
    for (int exponent = -1000; exponent <= 1000; exponent += 8)
        EXPECT_EQ(elementary::log2(std::ldexp(1, exponent)), exponent);
    EXPECT_EQ(elementary::log(1), 0);
}

TEST(Elementary, Logarithms_HaveTheDocumentedError) {
    constexpr double least = 0x1p-55;  // four of these are 2^-53
    const auto check = [](double x) {
        ASSERT_LE(error_of(elementary::log2(x), std::log2(static_cast<long double>(x)), least), 4) << x;
        ASSERT_LE(error_of(elementary::log(x), std::log(static_cast<long double>(x)), least), 4) << x;
    };
    for (double x = 1e-307; x < 1e307; x *= 1.0037) check(x);
    Random random(1);
    for (int i = 0; i < 100'000; ++i) check(random.uniform(0.5, 2));
    for (double away = 0.3; away > 1e-16; away *= 0.9)
        for (const double x : {1 - away, 1 + away}) check(x);
    for (const double x : {0x1p-1074, 0x1p-1022, 0x1.fffffffffffffp1023, std::sqrt(0.5), std::sqrt(2.0)}) check(x);
}

TEST(Elementary, Powers_HaveTheDocumentedError) {
    Random random(2);
    for (int i = 0; i < 100'000; ++i) {
        const double x = std::ldexp(random.uniform(0.5, 1), static_cast<int>(random.index(200)) - 100);
        const double power = random.uniform(-10, 10);
        const long double expected = std::pow(static_cast<long double>(x), static_cast<long double>(power));
        const double most = 4 + 4 * std::abs(power * std::log2(x));
        ASSERT_LE(error_of(elementary::pow(x, power), expected), most) << x << " ^ " << power;
    }
    EXPECT_EQ(elementary::pow(4, 0.5), 2);
    EXPECT_EQ(elementary::pow(0x1p-30, 3), 0x1p-90);
    EXPECT_EQ(elementary::pow(7, 0), 1);
    EXPECT_EQ(elementary::pow(1, 1e300), 1);
    EXPECT_EQ(elementary::pow(2, -1022), 0x1p-1022);
}

TEST(Elementary, CosinesAndSines_HaveTheDocumentedError) {
    const auto check = [](double angle) {
        const auto [cosine, sine] = elementary::turn_of(angle);
        ASSERT_LE(error_of(cosine, std::cos(static_cast<long double>(angle))), 2) << angle;
        ASSERT_LE(error_of(sine, std::sin(static_cast<long double>(angle))), 2) << angle;
    };
    Random random(3);
    for (int i = 0; i < 300'000; ++i) {
        check(random.uniform(-pi / 4, pi / 4));
        check(random.uniform(-3.9, 3.9));
    }
    for (int degrees = -220; degrees <= 220; ++degrees) {
        const double angle = degrees * (pi / 180);
        for (const double beside : {std::nextafter(angle, -9), angle, std::nextafter(angle, 9)}) check(beside);
    }
    for (double angle = 1; angle > 1e-300; angle *= 0.7)
        for (const double signed_angle : {angle, -angle, pi / 2 - angle, pi + angle}) check(signed_angle);
}

TEST(Elementary, CosinesAndSines_OfQuarterTurns) {
    EXPECT_EQ(elementary::turn_of(0).cosine, 1);
    EXPECT_EQ(elementary::turn_of(0).sine, 0);
    EXPECT_EQ(elementary::turn_of(pi / 2).sine, 1);
    EXPECT_NEAR(elementary::turn_of(pi / 2).cosine, 0, 1e-16);
    EXPECT_EQ(elementary::turn_of(pi).cosine, -1);
    EXPECT_EQ(elementary::turn_of(-pi / 2).sine, -1);
}

}  // namespace
}  // namespace scanmill
