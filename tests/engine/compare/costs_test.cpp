// SPDX-License-Identifier: GPL-3.0-or-later
// The rank test against enumeration and closed forms, and the judgement of costs on made and on simulated noise.

#include "scanmill/compare/costs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <vector>

#include "scanmill/base/random.hpp"

namespace scanmill::test {
namespace {

using Values = std::vector<double>;

/// Twice the rank of a value among all, ties by mid-ranks: 1 + twice the smaller ones + the other equal ones.
std::size_t doubled_rank(const Values& all, double value) {
    std::size_t rank = 1;
    for (const double other : all) rank += other < value ? 2 : other == value ? 1 : 0;
    return rank;
}

/// Every choice of which values are the larger side's, by its bits.
ExactProbability enumerated(const Values& larger, const Values& smaller) {
    Values all = larger;
    all.insert(all.end(), smaller.begin(), smaller.end());
    const auto sum_of = [&](unsigned choice) {
        std::size_t sum = 0;
        for (std::size_t i = 0; i < all.size(); ++i)
            if (choice >> i & 1u) sum += doubled_rank(all, all[i]);
        return sum;
    };
    const std::size_t found = sum_of((1u << larger.size()) - 1);
    ExactProbability probability{0, 0};
    for (unsigned choice = 0; choice < 1u << all.size(); ++choice) {
        if (static_cast<std::size_t>(std::popcount(choice)) != larger.size()) continue;
        ++probability.total;
        probability.favourable += sum_of(choice) >= found;
    }
    return probability;
}

Values drawn(Random& random, std::size_t size, std::uint64_t different) {
    Values values;
    for (std::size_t i = 0; i < size; ++i) values.push_back(static_cast<double>(1 + random.index(different)));
    return values;
}

TEST(RankTest, AnySizesAndTies_EqualEnumeration) {
    Random random(1);
    for (const std::uint64_t different : {1, 2, 3, 5, 100, 1'000'000})
        for (std::size_t larger = 1; larger <= 6; ++larger)
            for (std::size_t smaller = 1; smaller <= 8; ++smaller) {
                const Values a = drawn(random, larger, different), b = drawn(random, smaller, different);
                ASSERT_EQ(rank_test(a, b), enumerated(a, b)) << larger << " " << smaller << " " << different;
                ASSERT_EQ(rank_test(b, a), enumerated(b, a));
            }
}

TEST(RankTest, HandCase) {
    // Ten choices of two of 1, 2, 3, 4, 5 exist; only {5, 4} and {5, 3} have a sum of at least 8.
    EXPECT_EQ(rank_test(Values{3, 5}, Values{1, 2, 4}), (ExactProbability{2, 10}));
    // Mid-ranks of 1, 2, 2, 3: 1, 2½, 2½, 4. Sums of two of at least 6½: 4 + 2½, twice.
    EXPECT_EQ(rank_test(Values{2, 3}, Values{1, 2}), (ExactProbability{2, 6}));
}

TEST(RankTest, CompleteSeparation_IsOneOfAllChoices) {
    Values low(20), high(20);
    std::iota(low.begin(), low.end(), 1);
    std::iota(high.begin(), high.end(), 21);
    EXPECT_EQ(rank_test(high, low), (ExactProbability{1, 137'846'528'820}));  // 40! / 20!²
    EXPECT_EQ(rank_test(low, high), (ExactProbability{137'846'528'820, 137'846'528'820}));
    EXPECT_EQ(rank_test(Values{21, 22, 23}, low), (ExactProbability{1, 1771}));  // 23·22·21 / 6
    EXPECT_EQ(rank_test(Values{21}, low), (ExactProbability{1, 21}));
}

TEST(RankTest, EqualValues_SayNothing) {
    EXPECT_EQ(rank_test(Values(20, 1.0), Values(20, 1.0)).value(), 1);
    EXPECT_EQ(rank_test(Values(1, 2.0), Values(1, 2.0)), (ExactProbability{2, 2}));
}

TEST(RankTest, BothDirections_ShareTheCentre) {
    // P(R >= r) + P(R <= r) = 1 + P(R = r), so the two one-sided tests overlap by at least the observed choice.
    Random random(2);
    for (int i = 0; i < 50; ++i) {
        const Values a = drawn(random, 7, 30), b = drawn(random, 12, 30);
        const ExactProbability up = rank_test(a, b), down = rank_test(b, a);
        EXPECT_EQ(up.total, down.total);
        EXPECT_GT(up.favourable + down.favourable, up.total);
    }
}

TEST(ExactProbability, Limit_IsStrict) {
    EXPECT_FALSE((ExactProbability{1, 1000}.is_below_one_in(1000)));
    EXPECT_TRUE((ExactProbability{1, 1001}.is_below_one_in(1000)));
    EXPECT_FALSE((ExactProbability{2, 1771}.is_below_one_in(1000)));
}

TEST(Median, OfAnyOrderAndNumber) {
    EXPECT_EQ(median(Values{3, 1, 2}), 2);
    EXPECT_EQ(median(Values{4, 1, 3, 2}), 2.5);
    EXPECT_EQ(median(Values{7}), 7);
}

/// `count` values near `centre` that all differ.
Values around(double centre, std::size_t count) {
    Values values;
    for (std::size_t i = 0; i < count; ++i)
        values.push_back(centre * (1 + 0.001 * (static_cast<double>(i) - static_cast<double>(count) / 2)));
    return values;
}

TEST(JudgeCosts, LargePool_FloorAndRanksDecide) {
    const Values before = around(10, 20);
    EXPECT_TRUE(judge_costs(before, around(13, 3), 0.2).is_worse);
    EXPECT_FALSE(judge_costs(before, around(11.9, 3), 0.2).is_worse) << "below the floor";
    EXPECT_TRUE(judge_costs(before, around(7, 3), 0.2).is_better);
    const CostJudgement same = judge_costs(before, around(10, 3), 0.2);
    EXPECT_FALSE(same.is_worse || same.is_better || same.probability);
    EXPECT_EQ(*judge_costs(before, around(13, 3), 0.2).probability, 1.0 / 1771);
}

TEST(JudgeCosts, Floor_IsNotExceededByItself) {
    EXPECT_FALSE(judge_costs(Values(20, 10.0), Values(3, 12.5), 0.25).is_worse);
    EXPECT_TRUE(judge_costs(Values(20, 10.0), Values(3, 12.6), 0.25).is_worse);
    EXPECT_FALSE(judge_costs(Values(3, 10.0), Values(3, 15.0), 0.25).is_worse);
    EXPECT_TRUE(judge_costs(Values(3, 10.0), Values(3, 15.1), 0.25).is_worse);
}

TEST(JudgeCosts, ABlipInSomePasses_DoesNotTrip) {
    for (const std::size_t pool : {3u, 7u, 8u, 20u}) {
        EXPECT_FALSE(judge_costs(around(10, pool), Values{10, 90, 10.1}, 0.2).is_worse) << pool;
        EXPECT_FALSE(judge_costs(around(10, pool), Values{80, 90, 10.1}, 0.2).is_worse) << pool;
    }
}

TEST(JudgeCosts, ABlipInThePool_DoesNotHideASlowdown) {
    Values before = around(10, 6);
    before.push_back(300);
    EXPECT_TRUE(judge_costs(before, around(20, 3), 0.2).is_worse) << "a pool below 8";
    before = around(10, 18);
    before.insert(before.end(), {300, 400});
    EXPECT_TRUE(judge_costs(before, around(20, 3), 0.2).is_worse);
    EXPECT_FALSE(judge_costs(before, around(13, 3), 0.2).is_worse) << "a small one needs better ranks";
}

TEST(JudgeCosts, SmallPools_NeedTwiceTheTolerance) {
    for (const std::size_t pool : {1u, 7u}) {
        EXPECT_FALSE(judge_costs(around(10, pool), around(13.9, 3), 0.2).is_worse) << pool;
        const CostJudgement judged = judge_costs(around(10, pool), around(14.2, 3), 0.2);
        EXPECT_TRUE(judged.is_worse) << pool;
        EXPECT_FALSE(judged.probability);
    }
    // 8 and 3 passes have 165 choices: no probability is below 1 in 1000.
    EXPECT_FALSE(judge_costs(around(10, 8), around(13.9, 3), 0.2).is_worse);
    EXPECT_TRUE(judge_costs(around(10, 8), around(14.2, 3), 0.2).is_worse);
    Values above = around(10, 5);
    above.insert(above.end(), {15, 15, 15});
    EXPECT_FALSE(judge_costs(above, Values{14.2, 14.3, 14.4}, 0.2).is_worse) << "the ranks are not improbable";
}

TEST(JudgeCosts, OnePass_IsJudgedAtTwiceTheTolerance) {
    for (const std::size_t pool : {1u, 10u, 19u, 20u}) {
        EXPECT_TRUE(judge_costs(around(10, pool), Values{14.2}, 0.2).is_worse) << pool;
        EXPECT_FALSE(judge_costs(around(10, pool), Values{13.9}, 0.2).is_worse) << pool;
    }
}

TEST(JudgeCosts, OnlyTheLastTwenty_Count) {
    Values before(30, 100.0);
    const Values recent = around(10, 20);
    before.insert(before.end(), recent.begin(), recent.end());
    EXPECT_TRUE(judge_costs(before, around(20, 3), 0.2).is_worse);
}

TEST(JudgeCosts, TimeWithoutProcessorTime_NeedsMore) {
    EXPECT_TRUE(judge_costs(around(10, 20), around(15, 3), 0.2, CostKind::time).is_worse);
    EXPECT_FALSE(judge_costs(around(10, 20), around(15, 3), 0.2, CostKind::unconfirmed_time).is_worse);
    EXPECT_TRUE(judge_costs(around(10, 20), around(20, 3), 0.2, CostKind::unconfirmed_time).is_worse);
    EXPECT_TRUE(judge_costs(around(10, 3), around(20, 3), 0.2, CostKind::unconfirmed_time).is_worse);
    EXPECT_FALSE(judge_costs(around(0.005, 20), around(0.020, 3), 0.2, CostKind::unconfirmed_time).is_worse)
        << "a few time slices";
    EXPECT_TRUE(judge_costs(around(0.005, 20), around(0.030, 3), 0.2, CostKind::unconfirmed_time).is_worse);
    EXPECT_TRUE(judge_costs(around(0.005, 20), around(0.020, 3), 0.2, CostKind::time).is_worse);
    EXPECT_FALSE(judge_costs(around(0.0008, 20), around(0.0013, 3), 0.2, CostKind::time).is_worse) << "the caches";
}

/// Passes of a cell on a noisy machine: multiplied by e^(σ·normal), by drift over the nights, and by bursts in which
/// other programs take up to two thirds of the processor for one pass.
class Machine {
public:
    explicit Machine(std::uint64_t seed) : random_(seed) {}

    void begin_night() { drift_ = std::clamp(drift_ + 0.01 * random_.normal(), -0.05, 0.05); }
    Values passes(double seconds, std::size_t count) {
        Values passes;
        for (std::size_t i = 0; i < count; ++i) {
            const double burst = random_.uniform() < 0.03 ? random_.uniform(1, 3) : 1;
            passes.push_back(seconds * (1 + drift_) * grown(0.05 * random_.normal()) * burst);
        }
        return passes;
    }

private:
    /// e^x by its series: the same bits on every processor.
    static double grown(double x) {
        double sum = 1, term = 1;
        for (int i = 1; i < 20; ++i) sum += term *= x / i;
        return sum;
    }
    Random random_;
    double drift_ = 0;
};

TEST(JudgeCosts, TwentyNightsOfAHundredUnchangedCells_HaveNoFalseAlarm) {
    for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
        Machine machine(seed);
        std::vector<Values> pools(100);
        std::size_t alarms = 0, found = 0, judged = 0;
        for (int night = 0; night < 20; ++night) {
            machine.begin_night();
            for (std::size_t cell = 0; cell < pools.size(); ++cell) {
                const Values passes = machine.passes(0.01 * static_cast<double>(cell + 1), 3);
                if (!pools[cell].empty()) {
                    ++judged;
                    alarms += judge_costs(pools[cell], passes, 0.2).is_worse;
                    Values slower = passes;
                    for (double& each : slower) each *= 2;
                    found += judge_costs(pools[cell], slower, 0.2).is_worse;
                }
                pools[cell].insert(pools[cell].end(), passes.begin(), passes.end());
            }
        }
        EXPECT_EQ(alarms, 0u) << seed;
        EXPECT_EQ(judged, 1900u);
        // Several bursts among the earlier passes, or few earlier passes, hide what doubles: for a night.
        EXPECT_GT(found, judged * 97 / 100) << seed;
    }
}

}  // namespace
}  // namespace scanmill::test
