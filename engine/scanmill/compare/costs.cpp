// SPDX-License-Identifier: GPL-3.0-or-later
// H. B. Mann, D. R. Whitney: On a test of whether one of two random variables is stochastically larger than the other.
// Annals of Mathematical Statistics 18 (1947). Ties get mid-ranks; probabilities are conditional on the ties found.
#include "scanmill/compare/costs.hpp"

#include <algorithm>
#include <cassert>
#include <vector>

namespace scanmill {

namespace {

/// Twice the mid-rank of every value, first of `first`, then of `second`. The factor 2 makes the ranks whole numbers.
std::vector<std::size_t> doubled_ranks(std::span<const double> first, std::span<const double> second) {
    std::vector<double> values(first.begin(), first.end());
    values.insert(values.end(), second.begin(), second.end());
    std::vector<double> sorted = values;
    std::ranges::sort(sorted);
    std::vector<std::size_t> ranks;
    for (const double value : values) {
        const auto [low, high] = std::ranges::equal_range(sorted, value);
        // The ranks of equal values are low + 1 to high. Their mean is half of the sum of these two.
        ranks.push_back(static_cast<std::size_t>((low - sorted.begin()) + 1 + (high - sorted.begin())));
    }
    return ranks;
}

/// counts[s] is the number of ways to choose `chosen` of the ranks with the sum s.
std::vector<std::uint64_t> choices_by_sum(const std::vector<std::size_t>& ranks, std::size_t chosen) {
    std::vector<std::size_t> sorted = ranks;
    std::ranges::sort(sorted, std::greater<>());
    std::size_t largest = 0;
    for (std::size_t i = 0; i < chosen; ++i) largest += sorted[i];
    std::vector<std::vector<std::uint64_t>> counts(chosen + 1, std::vector<std::uint64_t>(largest + 1));
    counts[0][0] = 1;
    for (const std::size_t rank : ranks)
        for (std::size_t size = chosen; size > 0; --size)
            for (std::size_t sum = largest; sum >= rank; --sum) counts[size][sum] += counts[size - 1][sum - rank];
    return counts[chosen];
}

std::uint64_t binomial(std::uint64_t all, std::uint64_t chosen) {
    std::uint64_t result = 1;
    for (std::uint64_t i = 1; i <= chosen; ++i) result = result * (all - chosen + i) / i;  // exact at every step
    return result;
}

}  // namespace

ExactProbability rank_test(std::span<const double> larger, std::span<const double> smaller) {
    assert(!larger.empty() && larger.size() <= most_ranked && !smaller.empty() && smaller.size() <= most_ranked);
    // Counts the side with fewer values. High ranks of `larger` mean low ranks of `smaller`.
    const bool counts_larger = larger.size() <= smaller.size();
    const std::span<const double> counted = counts_larger ? larger : smaller;
    const std::vector<std::size_t> ranks = doubled_ranks(counted, counts_larger ? smaller : larger);
    std::size_t found = 0;
    for (std::size_t i = 0; i < counted.size(); ++i) found += ranks[i];
    const std::vector<std::uint64_t> counts = choices_by_sum(ranks, counted.size());
    ExactProbability probability{0, binomial(ranks.size(), counted.size())};
    for (std::size_t sum = 0; sum < counts.size(); ++sum)
        if (counts_larger ? sum >= found : sum <= found) probability.favourable += counts[sum];
    return probability;
}

double median(std::span<const double> values) {
    assert(!values.empty());
    std::vector<double> sorted(values.begin(), values.end());
    std::ranges::sort(sorted);
    const std::size_t middle = sorted.size() / 2;
    return sorted.size() % 2 == 1 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

namespace {

/// Whether the difference of `high` and `low` by this share counts, by the rules of judge_costs(). Sets `probability`
/// if it uses the rank test.
bool is_borne_out(double share, std::span<const double> high, std::span<const double> low, bool is_ranked,
                  double tolerance, double limit, std::optional<double>& probability) {
    if (!(share > limit)) return false;
    const bool is_large = share > 2 * tolerance;
    if (!is_ranked || binomial(high.size() + low.size(), high.size()) <= weak) return is_large;
    const ExactProbability found = rank_test(high, low);
    probability = found.value();
    return found.is_below_one_in(is_large ? weak : strong);
}

double rise_of_all(std::span<const double> before, std::span<const double> now) {
    return *std::ranges::min_element(now) / median(before) - 1;
}

}  // namespace

bool all_rise(std::span<const double> before, std::span<const double> now, double tolerance) {
    return rise_of_all(before, now) > tolerance;
}

CostJudgement judge_costs(std::span<const double> before, std::span<const double> now, double tolerance,
                          CostKind kind) {
    assert(!before.empty() && !now.empty() && now.size() <= most_ranked);
    if (before.size() > most_ranked) before = before.last(most_ranked);
    const bool is_ranked = before.size() >= least_ranked;
    CostJudgement judgement{median(before), median(now), false, false, {}};
    const double rise = rise_of_all(before, now), fall = judgement.before / *std::ranges::max_element(now) - 1;
    double limit = tolerance;
    if (kind == CostKind::time) limit = std::max(limit, least_seconds / judgement.before);
    if (kind == CostKind::unconfirmed_time)
        limit = std::max(unconfirmed_factor * tolerance, unconfirmed_seconds / judgement.before);
    judgement.is_worse = is_borne_out(rise, now, before, is_ranked, tolerance, limit, judgement.probability);
    judgement.is_better =
        !judgement.is_worse && is_borne_out(fall, before, now, is_ranked, tolerance, tolerance, judgement.probability);
    return judgement;
}

}  // namespace scanmill
