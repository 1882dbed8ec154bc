// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What is said of many distances.

#include <optional>
#include <span>

#include "scanmill/data/array.hpp"

namespace scanmill {

/// Quantiles are by nearest rank: p95 is the smallest distance with at least 95 % of the samples not above it.
struct DistanceNumbers {
    std::size_t samples = 0;
    double mean = 0;
    /// Standard error of the mean. The samples are dealt in turn to 32 batches, with means m_i around their mean m:
    /// sqrt(Σ (m_i - m)² / (32 · 31)). Evenly spread samples vary less than that, seldom more.
    /// Absent where nothing was sampled: a cloud's points are all taken.
    std::optional<double> mean_spread;
    double rms = 0;
    double p50 = 0, p90 = 0, p95 = 0, p99 = 0;
    /// Over the samples and all vertices of their side.
    double max = 0;
};

namespace measuring {

/// Pre: at least one distance, none NaN. Fewer than 32 are no batches: their spread is 0.
/// `vertices` count for the maximum only. Reorders nothing.
DistanceNumbers numbers_of(std::span<const double> distances, std::span<const double> vertices);

/// Both sides, each with half of the weight. Pre: equally many distances on both.
DistanceNumbers numbers_of_both(const DistanceNumbers& one, std::span<const double> distances_of_one,
                                const DistanceNumbers& other, std::span<const double> distances_of_other);

/// Share of distances that are at most `threshold`.
double share_within(std::span<const double> distances, double threshold);

/// The smallest value with at least `share` of all not above it. Pre: values sorted, at least one; 0 ≤ share ≤ 1.
double quantile(std::span<const double> sorted, double share);

}  // namespace measuring

}  // namespace scanmill
