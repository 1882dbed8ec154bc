// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Statistics of many distances.

#include <cmath>
#include <optional>
#include <span>

#include "scanmill/data/array.hpp"
#include "scanmill/geometry/distance/compensated_sum.hpp"

namespace scanmill {

/// Quantiles are by nearest rank: p95 is the smallest distance that at least 95 % of the samples do not exceed.
struct DistanceNumbers {
    std::size_t samples = 0;
    double mean = 0;
    /// Standard error of the mean. Sample i belongs to batch i mod 32. With batch means m_i and their mean m, the
    /// standard error is sqrt(Σ (m_i - m)² / (32 · 31)). The mean of evenly spread samples usually varies less than
    /// that. Absent for the points of a cloud, because all points are used.
    std::optional<double> mean_spread;
    double rms = 0;
    double p50 = 0, p90 = 0, p95 = 0, p99 = 0;
    /// Largest distance of the samples and of all vertices of their surface.
    double max = 0;
};

namespace measuring {

/// `vertices`: distances of vertices, which count for the maximum only. With fewer than 32 distances, mean_spread is 0.
/// Pre: at least one distance, no NaN.
DistanceNumbers numbers_of(std::span<const double> distances, std::span<const double> vertices);

/// Numbers of both directions together, each with half of the weight. Pre: the same number of distances in both
/// directions.
DistanceNumbers numbers_of_both(const DistanceNumbers& one, std::span<const double> distances_of_one,
                                const DistanceNumbers& other, std::span<const double> distances_of_other);

/// Share of the distances that are at most `threshold`.
double share_within(std::span<const double> distances, double threshold);

/// The smallest value that at least `share` of all values do not exceed. Pre: sorted values, at least one;
/// 0 ≤ share ≤ 1.
double quantile(std::span<const double> sorted, double share);

}  // namespace measuring

}  // namespace scanmill
