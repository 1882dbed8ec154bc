// SPDX-License-Identifier: GPL-3.0-or-later
#include "inspect/deviation_numbers.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "scanmill/base/statistics.hpp"
#include "scanmill/geometry/distance/compensated_sum.hpp"

namespace scanmill::inspecting {

namespace {

/// Candidates that are sorted at first; each further block is twice as large.
constexpr std::size_t first_block = 1 << 12;

}  // namespace

Spread spread_of(std::span<const double> deviations) {
    assert(!deviations.empty());
    const auto count = static_cast<double>(deviations.size());
    CompensatedSum sum, squares;
    for (const double deviation : deviations) sum.add(deviation);
    const double mean = sum.value() / count;
    for (const double deviation : deviations) squares.add((deviation - mean) * (deviation - mean));
    return {mean, std::sqrt(squares.value() / count)};
}

DeviationNumbers numbers_of(std::span<double> deviations, const Tolerance& tolerance) {
    assert(!deviations.empty());
    const auto count = static_cast<double>(deviations.size());
    DeviationNumbers numbers;
    numbers.counted = deviations.size();
    const auto [mean, standard_deviation] = spread_of(deviations);
    numbers.mean = mean;
    numbers.standard_deviation = standard_deviation;
    CompensatedSum squares, positive, negative;
    std::size_t positives = 0, negatives = 0, above = 0, below = 0;
    numbers.min = numbers.max = deviations.front();
    for (const double deviation : deviations) {
        squares.add(deviation * deviation);
        if (deviation > 0) positive.add(deviation), ++positives;
        if (deviation < 0) negative.add(deviation), ++negatives;
        above += deviation > tolerance.high;
        below += deviation < tolerance.low;
        numbers.min = std::min(numbers.min, deviation);
        numbers.max = std::max(numbers.max, deviation);
    }
    numbers.rms = std::sqrt(squares.value() / count);
    if (positives > 0) numbers.mean_above = positive.value() / static_cast<double>(positives);
    if (negatives > 0) numbers.mean_below = negative.value() / static_cast<double>(negatives);
    numbers.in_tolerance = static_cast<double>(deviations.size() - above - below) / count;
    numbers.above = static_cast<double>(above) / count;
    numbers.below = static_cast<double>(below) / count;
    numbers.p50 = quantile(deviations, 0.50);
    numbers.p1 = quantile(deviations, 0.01);
    numbers.p5 = quantile(deviations, 0.05);
    numbers.p95 = quantile(deviations, 0.95);
    numbers.p99 = quantile(deviations, 0.99);
    return numbers;
}

std::vector<double> histogram_of(std::span<const double> deviations, double low, double high, std::size_t bins) {
    assert(!deviations.empty() && low < high && bins > 0);
    std::vector<std::size_t> counts(bins, 0);
    const auto edge = [&](std::size_t bin) {
        return low + static_cast<double>(bin) * (high - low) / static_cast<double>(bins);
    };
    for (const double deviation : deviations) {
        const double share = std::clamp((deviation - low) / (high - low), 0.0, 1.0);
        std::size_t bin = std::min(static_cast<std::size_t>(share * static_cast<double>(bins)), bins - 1);
        // Rounding of the quotient may miss the bin by one.
        if (bin > 0 && deviation < edge(bin)) --bin;
        if (bin + 1 < bins && deviation >= edge(bin + 1)) ++bin;
        ++counts[bin];
    }
    std::vector<double> shares;
    for (const std::size_t count : counts)
        shares.push_back(static_cast<double>(count) / static_cast<double>(deviations.size()));
    return shares;
}

std::vector<u32> largest_apart(std::span<const u32> rows, std::span<const Vec3> positions,
                               std::span<const double> deviations, std::size_t count, double distance,
                               const Execution& execution) {
    std::vector<u32> chosen;
    if (count == 0) return chosen;
    std::vector<u32> candidates(rows.begin(), rows.end());
    const auto comes_first = [&](u32 one, u32 other) {
        const double here = std::abs(deviations[one]), there = std::abs(deviations[other]);
        return here != there ? here > there : one < other;
    };
    std::size_t block = first_block;
    for (auto first = candidates.begin(); first != candidates.end(); block *= 2) {
        execution.check_cancelled();
        const auto left = static_cast<std::size_t>(candidates.end() - first);
        const auto last = first + static_cast<std::ptrdiff_t>(std::min(block, left));
        if (last != candidates.end()) std::nth_element(first, last, candidates.end(), comes_first);
        std::sort(first, last, comes_first);
        for (; first != last; ++first) {
            const auto is_near = [&](u32 other) {
                return (positions[*first] - positions[other]).squaredNorm() < distance * distance;
            };
            if (std::ranges::any_of(chosen, is_near)) continue;
            chosen.push_back(*first);
            if (chosen.size() == count) return chosen;
        }
    }
    return chosen;
}

}  // namespace scanmill::inspecting
