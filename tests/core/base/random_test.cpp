// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/base/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace scanmill::test {
namespace {

/// Seeds whose first number is the largest and the smallest possible: SplitMix64's mixing, run backwards.
constexpr std::uint64_t seed_of_largest = 0x31628af67b2131ab;
constexpr std::uint64_t seed_of_zero = 0x61c8864680b583eb;

std::vector<std::uint64_t> first_numbers(Random random, std::size_t count) {
    std::vector<std::uint64_t> numbers(count);
    for (std::uint64_t& number : numbers) number = random.next();
    return numbers;
}

TEST(Random, FirstNumbers_AreThePublishedOnesOfSplitMix64) {
    EXPECT_EQ(first_numbers(Random(1234567), 5),
              (std::vector<std::uint64_t>{6457827717110365317u, 3203168211198807973u, 9817491932198370423u,
                                          4593380528125082431u, 16408922859458223821u}));
    EXPECT_EQ(first_numbers(Random(0), 3),
              (std::vector<std::uint64_t>{0xe220a8397b1dcdafu, 0x6e789e6aa1b965f4u, 0x06c45d188009454fu}));
}

TEST(Random, Uniform_ReachesZeroAndStaysBelowOne) {
    ASSERT_EQ(Random(seed_of_largest).next(), std::numeric_limits<std::uint64_t>::max());
    ASSERT_EQ(Random(seed_of_zero).next(), 0u);
    EXPECT_EQ(Random(seed_of_largest).uniform(), 1 - 0x1p-53);
    EXPECT_EQ(Random(seed_of_zero).uniform(), 0);
}

TEST(Random, Uniform_FillsItsRangeEvenly) {
    constexpr int bins = 16, draws = 160'000;
    std::vector<int> hits(bins);
    Random random(5);
    double sum = 0;
    for (int i = 0; i < draws; ++i) {
        const double value = random.uniform(-3, 5);
        ASSERT_GE(value, -3);
        ASSERT_LT(value, 5);
        ++hits[static_cast<std::size_t>((value + 3) / 8 * bins)];
        sum += value;
    }
    double chi_square = 0;
    for (const int count : hits) chi_square += std::pow(count - draws / bins, 2) / (draws / bins);
    EXPECT_LT(chi_square, 44.3) << "15 degrees of freedom: passed by all but 1 in 10,000";
    EXPECT_NEAR(sum / draws, 1, 5 * 8 / std::sqrt(12.0 * draws));
}

TEST(Random, Index_ReachesItsFirstAndItsLastAndNoMore) {
    for (const std::uint64_t count : {1ull, 2ull, 7ull, 1ull << 32, ~0ull}) {
        EXPECT_EQ(Random(seed_of_largest).index(count), count - 1);
        EXPECT_EQ(Random(seed_of_zero).index(count), 0u);
    }
}

TEST(Random, Index_IsEven) {
    constexpr int draws = 70'000;
    std::vector<int> hits(7);
    Random random(6);
    for (int i = 0; i < draws; ++i) ++hits.at(random.index(7));
    double chi_square = 0;
    for (const int count : hits) chi_square += std::pow(count - draws / 7, 2) / (draws / 7);
    EXPECT_LT(chi_square, 27.9) << "6 degrees of freedom: passed by all but 1 in 10,000";
}

TEST(RandomStream, MakingStreams_DoesNotAdvance) {
    Random random(9);
    const Random untouched = random;
    random.stream(0);
    random.stream(1);
    EXPECT_EQ(first_numbers(random, 4), first_numbers(untouched, 4));
    EXPECT_EQ(first_numbers(random.stream(3), 4), first_numbers(untouched.stream(3), 4));
}

TEST(RandomStream, DependsOnIndexSeedAndState) {
    Random advanced(9);
    advanced.next();
    const auto first = first_numbers(Random(9).stream(1), 4);
    EXPECT_NE(first_numbers(Random(9).stream(2), 4), first);
    EXPECT_NE(first_numbers(Random(10).stream(1), 4), first);
    EXPECT_NE(first_numbers(advanced.stream(1), 4), first);
    EXPECT_NE(first_numbers(Random(9), 4), first);
}

TEST(RandomStream, SplittingAfterDrawing_GivesNoEarlierStream) {
    Random random(9);
    std::vector<std::uint64_t> firsts;
    for (int drawn = 0; drawn < 20; ++drawn, random.next())
        for (std::uint64_t index = 0; index < 20; ++index) firsts.push_back(random.stream(index).next());
    std::ranges::sort(firsts);
    EXPECT_EQ(std::ranges::adjacent_find(firsts), firsts.end());
}

TEST(RandomStream, ManyStreams_ShareNoNumber) {
    const Random random(0);
    std::vector<std::uint64_t> numbers = first_numbers(random, 100);
    for (std::uint64_t index = 0; index < 20'000; ++index) {
        const auto some = first_numbers(random.stream(index), 5);
        numbers.insert(numbers.end(), some.begin(), some.end());
    }
    std::ranges::sort(numbers);
    EXPECT_EQ(std::ranges::adjacent_find(numbers), numbers.end());
}

TEST(RandomStream, NeighbouringStreamsAndTheirParent_AreUncorrelated) {
    constexpr int draws = 40'000;
    const auto correlation = [](Random a, Random b) {
        double sum = 0;
        for (int i = 0; i < draws; ++i) sum += (a.uniform() - 0.5) * (b.uniform() - 0.5);
        return 12 * sum / draws;
    };
    const Random random(77);
    ASSERT_GT(correlation(random, random), 0.9) << "the measure detects equal streams";
    for (const std::uint64_t index : {0u, 1u, 2u, 1000u}) {
        EXPECT_NEAR(correlation(random.stream(index), random.stream(index + 1)), 0, 5 / std::sqrt(draws));
        EXPECT_NEAR(correlation(random, random.stream(index)), 0, 5 / std::sqrt(draws));
    }
    // The first numbers of successive streams, as when each item takes one.
    double sum = 0;
    for (std::uint64_t index = 0; index < draws; ++index)
        sum += (random.stream(index).uniform() - 0.5) * (random.stream(index + 1).uniform() - 0.5);
    EXPECT_NEAR(12 * sum / draws, 0, 5 / std::sqrt(draws));
}

TEST(RandomNormal, Moments_AreTheNormalDistributions) {
    constexpr int draws = 200'000;
    Random random(8);
    double sum = 0, squares = 0, fourth = 0;
    int within_one = 0;
    for (int i = 0; i < draws; ++i) {
        const double x = random.normal();
        sum += x;
        squares += x * x;
        fourth += x * x * x * x;
        within_one += std::abs(x) < 1;
    }
    const double deviation = 5 / std::sqrt(draws);  // five standard errors of a variable of variance 1
    EXPECT_NEAR(sum / draws, 0, deviation);
    EXPECT_NEAR(squares / draws, 1, deviation * std::sqrt(2.0));
    EXPECT_NEAR(fourth / draws, 3, deviation * std::sqrt(96.0));
    EXPECT_NEAR(static_cast<double>(within_one) / draws, std::erf(1 / std::sqrt(2.0)), deviation * 0.5);
}

TEST(RandomNormal, Numbers_AreThePolarMethodsToTheLastDigits) {
    // The generator has its own logarithm; numbers from the C library's logarithm differ by rounding only.
    Random random(21);
    for (int i = 0; i < 2000; ++i) {
        Random copy = random;
        double x, square;
        do {
            x = copy.uniform(-1, 1);
            const double y = copy.uniform(-1, 1);
            square = x * x + y * y;
        } while (!(square > 0 && square < 1));
        const double expected = x * std::sqrt(-2 * std::log(square) / square);
        ASSERT_NEAR(random.normal(), expected, 1e-13 * (1 + std::abs(expected))) << square;
        ASSERT_EQ(random.next(), copy.next()) << "as many numbers were drawn";
    }
}

}  // namespace
}  // namespace scanmill::test
