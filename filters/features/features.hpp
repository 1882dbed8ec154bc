// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The feature lines of a mesh as a filter: boundaries, holes, creases, corners. The rules stand with the function that
/// finds them, in geometry/feature_lines.hpp, because filters that grow a mesh give the same lines.

#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"

namespace scanmill {

/// find_features with this run's threads. Warns of triangles without area, of loops that had to be told apart by their
/// length, and of creases that were left out. Throws Error for a mesh without triangles, else as find_features.
/// Metrics: those of FeatureCounts.
FeatureLines features(const TriangleMesh& mesh, const FeatureParams& params, Context& context);

}  // namespace scanmill
