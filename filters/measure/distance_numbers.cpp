// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/distance_numbers.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace scanmill::measuring {

namespace {

constexpr std::size_t batches = 32;

void set_quantiles(DistanceNumbers& numbers, Array<double>& distances) {
    std::ranges::sort(distances);
    numbers.p50 = quantile(distances, 0.50);
    numbers.p90 = quantile(distances, 0.90);
    numbers.p95 = quantile(distances, 0.95);
    numbers.p99 = quantile(distances, 0.99);
}

double spread_of_mean(std::span<const double> distances) {
    if (distances.size() < batches) return 0;
    std::array<CompensatedSum, batches> sums;
    for (std::size_t i = 0; i < distances.size(); ++i) sums[i % batches].add(distances[i]);
    std::array<double, batches> means;
    double middle = 0;
    for (std::size_t i = 0; i < batches; ++i) {
        means[i] = sums[i].value() / static_cast<double>((distances.size() - i + batches - 1) / batches);
        middle += means[i] / batches;
    }
    double squares = 0;
    for (double mean : means) squares += (mean - middle) * (mean - middle);
    return std::sqrt(squares / (batches * (batches - 1)));
}

}  // namespace

double quantile(std::span<const double> sorted, double share) {
    assert(!sorted.empty());
    const double rank = std::ceil(share * static_cast<double>(sorted.size()));
    return sorted[std::min(static_cast<std::size_t>(std::max(rank, 1.0)), sorted.size()) - 1];
}

DistanceNumbers numbers_of(std::span<const double> distances, std::span<const double> vertices) {
    assert(!distances.empty());
    DistanceNumbers numbers;
    numbers.samples = distances.size();
    const double count = static_cast<double>(distances.size());
    CompensatedSum sum, squares;
    for (double distance : distances) {
        sum.add(distance);
        squares.add(distance * distance);
    }
    numbers.mean = sum.value() / count;
    numbers.rms = std::sqrt(squares.value() / count);
    numbers.mean_spread = spread_of_mean(distances);
    Array<double> sorted(distances.begin(), distances.end());
    set_quantiles(numbers, sorted);
    numbers.max = sorted.back();
    for (double distance : vertices) numbers.max = std::max(numbers.max, distance);
    return numbers;
}

DistanceNumbers numbers_of_both(const DistanceNumbers& one, std::span<const double> distances_of_one,
                                const DistanceNumbers& other, std::span<const double> distances_of_other) {
    assert(distances_of_one.size() == distances_of_other.size());
    DistanceNumbers numbers;
    numbers.samples = one.samples + other.samples;
    numbers.mean = (one.mean + other.mean) / 2;
    numbers.mean_spread = std::sqrt(*one.mean_spread * *one.mean_spread + *other.mean_spread * *other.mean_spread) / 2;
    numbers.rms = std::sqrt((one.rms * one.rms + other.rms * other.rms) / 2);
    Array<double> all(distances_of_one.begin(), distances_of_one.end());
    all.insert(all.end(), distances_of_other.begin(), distances_of_other.end());
    set_quantiles(numbers, all);
    numbers.max = std::max(one.max, other.max);
    return numbers;
}

double share_within(std::span<const double> distances, double threshold) {
    const auto within = std::ranges::count_if(distances, [&](double distance) { return distance <= threshold; });
    return static_cast<double>(within) / static_cast<double>(distances.size());
}

}  // namespace scanmill::measuring
