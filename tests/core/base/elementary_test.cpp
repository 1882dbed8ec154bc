// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/base/elementary.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace scanmill {
namespace {

constexpr double last_place = std::numeric_limits<double>::epsilon();

TEST(Elementary, Logarithms_AreThoseOfTheCLibraryToAFewUnitsInTheLastPlace) {
    for (int exponent = -1000; exponent <= 1000; exponent += 8)
        EXPECT_EQ(elementary::log2(std::ldexp(1, exponent)), exponent);
    for (double x = 1e-300; x < 1e300; x *= 1.37) {
        EXPECT_NEAR(elementary::log2(x), std::log2(x), 4 * last_place * std::abs(std::log2(x))) << x;
        EXPECT_NEAR(elementary::log(x), std::log(x), 4 * last_place * std::abs(std::log(x))) << x;
    }
    for (double x = 0.5; x < 2; x += 1e-3)
        EXPECT_NEAR(elementary::log(x), std::log(x), 4 * last_place * std::max(std::abs(std::log(x)), 0.5)) << x;
}

TEST(Elementary, Tangents_AreThoseOfTheCLibraryToAFewUnitsInTheLastPlace) {
    EXPECT_EQ(elementary::tan(0), 0);
    EXPECT_NEAR(elementary::tan(std::numbers::pi / 4), 1, 4 * last_place);
    for (double x = 1e-9; x < std::numbers::pi / 4; x *= 1.003)
        EXPECT_NEAR(elementary::tan(x), std::tan(x), 4 * last_place * x) << x;
}

}  // namespace
}  // namespace scanmill
