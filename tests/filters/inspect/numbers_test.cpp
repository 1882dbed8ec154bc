// SPDX-License-Identifier: GPL-3.0-or-later
/// Statistics, histogram and labels.
#include <gmock/gmock.h>

#include <numeric>

#include "filters/inspect/cases.hpp"
#include "inspect/deviation_numbers.hpp"

namespace scanmill::test {
namespace {

using ::testing::DoubleEq;
using ::testing::DoubleNear;
using ::testing::ElementsAre;

DeviationNumbers numbers(std::vector<double> values, const Tolerance& tolerance = {-1, 1}) {
    return inspecting::numbers_of(values, tolerance);
}

std::vector<double> random_values(std::size_t count) {
    Random random(11);
    std::vector<double> values(count);
    for (double& value : values) value = random.normal();
    return values;
}

TEST(InspectNumbers, ThreePoints_ByHand) {
    const DeviationNumbers found = numbers({2, -1, 5}, {-0.5, 2});
    EXPECT_EQ(found.counted, 3u);
    EXPECT_EQ(found.min, -1);
    EXPECT_EQ(found.max, 5);
    EXPECT_EQ(found.mean, 2);
    EXPECT_DOUBLE_EQ(found.rms, std::sqrt(10.0));  // (4 + 1 + 25) / 3
    EXPECT_DOUBLE_EQ(found.standard_deviation, std::sqrt(6.0));  // (0 + 9 + 9) / 3
    EXPECT_EQ(found.mean_above, 3.5);
    EXPECT_EQ(found.mean_below, -1);
    EXPECT_DOUBLE_EQ(found.in_tolerance, 1 / 3.0);
    EXPECT_DOUBLE_EQ(found.above, 1 / 3.0);
    EXPECT_DOUBLE_EQ(found.below, 1 / 3.0);
    EXPECT_EQ(found.p1, -1);
    EXPECT_EQ(found.p50, 2);
    EXPECT_EQ(found.p99, 5);
}

TEST(InspectNumbers, EndsOfTheTolerance_AreInside) {
    const DeviationNumbers found = numbers({-0.05, 0.1, 0.10000001, -0.0500001}, {-0.05, 0.1});
    EXPECT_EQ(found.in_tolerance, 0.5);
    EXPECT_EQ(found.above, 0.25);
    EXPECT_EQ(found.below, 0.25);
}

TEST(InspectNumbers, OneSide_HasNoMeanOnTheOther) {
    EXPECT_FALSE(numbers({1, 0}).mean_below);
    EXPECT_EQ(numbers({1, 0}).mean_above, 1) << "0 is on neither side";
    EXPECT_FALSE(numbers({0}).mean_above);
}

TEST(InspectNumbers, Percentiles_AreByNearestRank) {
    std::vector<double> values = random_values(997);
    const DeviationNumbers found = numbers(values);
    std::ranges::sort(values);
    const auto ranked = [&](double percent) {
        return values[static_cast<std::size_t>(std::ceil(percent / 100 * 997)) - 1];
    };
    EXPECT_EQ(found.p1, ranked(1));
    EXPECT_EQ(found.p5, ranked(5));
    EXPECT_EQ(found.p50, ranked(50));
    EXPECT_EQ(found.p95, ranked(95));
    EXPECT_EQ(found.p99, ranked(99));
}

TEST(InspectNumbers, LargeMean_KeepsTheDigitsOfTheSpread) {
    std::vector<double> values = random_values(10'000);
    const double spread = numbers(values).standard_deviation;
    for (double& value : values) value = value * 0x1p-20 + 1000;
    EXPECT_NEAR(numbers(values).standard_deviation * 0x1p20, spread, 1e-5);
}

TEST(InspectHistogram, Edges_BelongToTheBinTheyBegin) {
    const std::vector<double> values{-1, -0.5, 0, 0.49, 0.5, 1, -7, 9};
    EXPECT_THAT(inspecting::histogram_of(values, -1, 1, 4), ElementsAre(2 / 8.0, 1 / 8.0, 2 / 8.0, 3 / 8.0));
    EXPECT_THAT(inspecting::histogram_of(values, -1, 1, 1), ElementsAre(1));
}

TEST(InspectHistogram, Shares_SumToOneAndAgreeWithTheirEdges) {
    const std::vector<double> values = random_values(5000);
    const std::size_t bins = 41;
    const double low = -0.3, high = 0.7;
    const std::vector<double> shares = inspecting::histogram_of(values, low, high, bins);
    EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1, 1e-12);
    for (std::size_t bin = 1; bin + 1 < bins; ++bin) {
        const auto edge = [&](std::size_t i) { return low + static_cast<double>(i) * (high - low) / 41; };
        const auto inside =
            std::ranges::count_if(values, [&](double value) { return edge(bin) <= value && value < edge(bin + 1); });
        EXPECT_EQ(shares[bin], static_cast<double>(inside) / 5000) << bin;
    }
}

std::vector<u32> apart(const std::vector<double>& deviations, const Array<Vec3>& positions, std::size_t count,
                       double distance) {
    std::vector<u32> rows(deviations.size());
    std::iota(rows.begin(), rows.end(), u32(0));
    return inspecting::largest_apart(rows, positions, deviations, count, distance, Execution());
}

TEST(InspectLabels, LargestAbsoluteDeviation_ComesFirst) {
    const Array<Vec3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
    EXPECT_THAT(apart({0.1, -0.5, 0.4, 0.3, -0.2}, line, 3, 0), ElementsAre(1, 2, 3));
    // Row 2 is too near row 1; exactly the distance is far enough.
    EXPECT_THAT(apart({0.1, -0.5, 0.4, 0.3, -0.2}, line, 3, 2), ElementsAre(1, 3));
    EXPECT_THAT(apart({0.1, -0.5, 0.4, 0.3, -0.2}, line, 3, 1), ElementsAre(1, 2, 3));
    EXPECT_THAT(apart({0.1, -0.5, 0.4, 0.3, -0.2}, line, 9, 100), ElementsAre(1));
    EXPECT_TRUE(apart({0.1, -0.5, 0.4, 0.3, -0.2}, line, 0, 1).empty());
}

TEST(InspectLabels, Ties_GoToTheLowerRow) {
    const Array<Vec3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
    EXPECT_THAT(apart({0.5, -0.5, 0.5, -0.5}, line, 2, 0), ElementsAre(0, 1));
    EXPECT_THAT(apart({0.5, -0.5, 0.5, -0.5}, line, 2, 1.5), ElementsAre(0, 2));
}

TEST(InspectLabels, ManyPoints_AreChosenAsByRepeatedSearch) {
    const std::vector<double> deviations = random_values(20'000);
    const Array<Vec3> positions = random_points(20'000, {0, 0, 0}, {1, 1, 1}, 0, 9);
    std::vector<u32> expected;
    while (expected.size() < 40) {
        std::optional<u32> best;
        for (u32 row = 0; row < positions.size(); ++row) {
            const bool is_near = std::ranges::any_of(
                expected, [&](u32 other) { return (positions[row] - positions[other]).norm() < 0.3; });
            if (!is_near && (!best || std::abs(deviations[row]) > std::abs(deviations[*best]))) best = row;
        }
        if (!best) break;
        expected.push_back(*best);
    }
    EXPECT_EQ(apart(deviations, positions, 40, 0.3), expected);
}

}  // namespace
}  // namespace scanmill::test
