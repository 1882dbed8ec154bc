// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Statistics of many distances.

#include <cmath>
#include <optional>
#include <span>

#include "scanmill/data/array.hpp"

namespace scanmill {

/// Quantiles are by nearest rank: p95 is the smallest distance that at least 95 % of the samples do not exceed.
struct DistanceNumbers {
    std::size_t samples = 0;
    double mean = 0;
    /// Standard error of the mean. Sample i belongs to batch i mod 32. With batch means m_i and their mean m it is
    /// sqrt(Σ (m_i - m)² / (32 · 31)). Evenly spread samples vary less than that, rarely more.
    /// Absent for the points of a cloud: all of them are used.
    std::optional<double> mean_spread;
    double rms = 0;
    double p50 = 0, p90 = 0, p95 = 0, p99 = 0;
    /// Over the samples and all vertices of their surface.
    double max = 0;
};

namespace measuring {

/// Pre: at least one distance, no NaN. Fewer than 32 samples have a spread of 0. `vertices` count for the maximum only.
DistanceNumbers numbers_of(std::span<const double> distances, std::span<const double> vertices);

/// Both directions, each with half of the weight. Pre: the same number of distances in both.
DistanceNumbers numbers_of_both(const DistanceNumbers& one, std::span<const double> distances_of_one,
                                const DistanceNumbers& other, std::span<const double> distances_of_other);

/// Share of the distances that are at most `threshold`.
double share_within(std::span<const double> distances, double threshold);

/// The smallest value that at least `share` of all values do not exceed. Pre: sorted values, at least one;
/// 0 ≤ share ≤ 1.
double quantile(std::span<const double> sorted, double share);

/// A sum with the digits that additions lose (Neumaier 1974): its error does not grow with the number of terms.
class CompensatedSum {
public:
    void add(double term) {
        const double next = sum_ + term;
        lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - next) + term : (term - next) + sum_;
        sum_ = next;
    }
    double value() const { return sum_ + lost_; }

private:
    double sum_ = 0, lost_ = 0;
};

}  // namespace measuring

}  // namespace scanmill
