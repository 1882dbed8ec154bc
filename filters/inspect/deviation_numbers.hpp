// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Statistics of signed deviations, and the points that get a label.

#include <optional>
#include <span>
#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// Deviations from `low` to `high` are in tolerance, ends included.
struct Tolerance {
    double low = 0, high = 0;
};

struct DeviationNumbers {
    std::size_t counted = 0;
    double min = 0, max = 0, mean = 0, rms = 0;
    /// Root of the mean squared difference from the mean; divided by the number of points.
    double standard_deviation = 0;
    /// Mean of the deviations above 0, and of those below 0; absent if there are none.
    std::optional<double> mean_above, mean_below;
    /// Shares of the deviations in tolerance, above its high end, and below its low end.
    double in_tolerance = 0, above = 0, below = 0;
    /// Quantiles by nearest rank: p95 is the smallest deviation that at least 95 % of all do not exceed.
    double p1 = 0, p5 = 0, p50 = 0, p95 = 0, p99 = 0;
};

namespace inspecting {

/// Pre: at least one deviation, no NaN. Reorders the deviations. Cost: linear.
DeviationNumbers numbers_of(std::span<double> deviations, const Tolerance& tolerance);

/// Mean and standard deviation only.
struct Spread {
    double mean = 0, standard_deviation = 0;
};
/// Pre: at least one deviation, no NaN.
Spread spread_of(std::span<const double> deviations);

/// Shares of the deviations in `bins` equal parts of [low, high]. Bin i begins at low + i (high - low) / bins, which
/// belongs to it; `high` belongs to the last. The first and the last bin also count what is outside the range.
/// Pre: at least one deviation, low < high, bins ≥ 1.
std::vector<double> histogram_of(std::span<const double> deviations, double low, double high, std::size_t bins);

/// Rows of the largest absolute deviations: at most `count`, each at least `distance` from all before it. The next row
/// is always that with the largest absolute deviation that is far enough from the rows chosen before. Ties: the lowest
/// row. `rows`: the candidates, ascending.
/// Cost: usually linear; in the worst case O(candidates · count).
std::vector<u32> largest_apart(std::span<const u32> rows, std::span<const Vec3> positions,
                               std::span<const double> deviations, std::size_t count, double distance,
                               const Execution& execution);

}  // namespace inspecting

}  // namespace scanmill
