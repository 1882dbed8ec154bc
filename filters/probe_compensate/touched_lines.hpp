// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Lines through touched points.

#include <optional>
#include <span>
#include <vector>

#include "scanmill/data/features.hpp"

namespace scanmill::compensating {

struct LinePoint {
    Vec3 position;
    double feature;  ///< number of the line
    bool is_exact;  ///< whether two touches fix it
};

struct TouchedLines {
    FeatureGraph graph;
    std::vector<std::size_t> points;  ///< for each vertex of the graph, its index among the given points
    std::size_t lone = 0;  ///< points in no line
    std::size_t repeated = 0;  ///< points left out beside another one of the same place
};

/// Joins the points of one feature, in their order, as probe_compensate() states. Lines are in the order in which their
/// features appear first. `spacing`: the distance of neighbours; empty for the median of each feature. Consecutive
/// points nearer than a quarter of the spacing and of the median distance are of one place. The line gets one of them:
/// the first exact one, or else the first.
/// Cost: O(n log n).
TouchedLines touched_lines(const Frame& frame, std::span<const LinePoint> points, std::optional<double> spacing);

}  // namespace scanmill::compensating
