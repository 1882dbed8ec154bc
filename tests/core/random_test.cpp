// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace scanmill::test {
namespace {

/// Steele, Lea, Flood 2014; the first numbers of seed 1234567 as other implementations publish them.
TEST(Random, SplitMix64_GivesThePublishedNumbers) {
    Random random(1234567);
    EXPECT_EQ(random.next(), 6457827717110365317u);
    EXPECT_EQ(random.next(), 3203168211198807973u);
    EXPECT_EQ(random.next(), 9817491932198370423u);
}

/// The logarithm inside is our own; the C library's must agree to the last digits.
TEST(Random, Normal_IsThePolarMethodOverTheUniformNumbers) {
    Random normals(5), uniforms(5);
    for (int i = 0; i < 100000; ++i) {
        double x, square;
        do {
            x = uniforms.uniform(-1, 1);
            const double y = uniforms.uniform(-1, 1);
            square = x * x + y * y;
        } while (square >= 1 || square == 0);
        const double expected = x * std::sqrt(-2 * std::log(square) / square);
        ASSERT_NEAR(normals.normal(), expected, 1e-14 + 1e-13 * std::abs(expected));
    }
}

TEST(Random, Uniform_StaysBelowOneWithTheMeanOfAHalf) {
    Random random(2);
    double sum = 0;
    for (int i = 0; i < 100000; ++i) {
        const double value = random.uniform();
        ASSERT_GE(value, 0);
        ASSERT_LT(value, 1);
        sum += value;
    }
    EXPECT_NEAR(sum / 100000, 0.5, 5 / std::sqrt(12.0 * 100000));
}

TEST(Random, Index_ReachesEveryNumberBelowTheCountAndNoOther) {
    Random random(3);
    std::set<std::uint64_t> seen;
    for (int i = 0; i < 1000; ++i) seen.insert(random.index(7));
    EXPECT_EQ(seen, (std::set<std::uint64_t>{0, 1, 2, 3, 4, 5, 6}));
}

TEST(Random, Streams_DifferAndDoNotAdvanceTheirParent) {
    Random random(1), untouched(1);
    std::set<std::uint64_t> firsts;
    for (std::uint64_t i = 0; i < 1000; ++i) firsts.insert(random.stream(i).next());
    EXPECT_EQ(firsts.size(), 1000u);
    EXPECT_EQ(random.next(), untouched.next());
}

}  // namespace
}  // namespace scanmill::test
