// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Touched lines that follow curved edges between the touches.

#include <vector>

#include "scanmill/data/features.hpp"

namespace scanmill::compensating {

/// The lines with further points between their own, so that chords deviate from the edge by about `chord_error` at
/// most. A chord gets at most 64 parts.
///
/// Between two points the edge is the mean of two circles, weighted by the distance from each point: the circle through
/// the previous point and both, and that through both and the next one. Circles are thus exact. Where only one of the
/// circles exists, at the end of a line or beside a point that is not exact, it counts alone. Three points have no
/// circle at a corner, where the line turns by more than 45 degrees, and where one distance is more than 4 times the
/// other. Without a circle the chord stays straight.
///
/// `is_exact`: by position of the graph. New positions follow the given ones; the corners stay. Pre: chord_error > 0.
FeatureGraph along_arcs(const FeatureGraph& lines, const std::vector<bool>& is_exact, double chord_error);

}  // namespace scanmill::compensating
