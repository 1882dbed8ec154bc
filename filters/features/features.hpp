// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The feature lines of a mesh as a filter: boundaries, holes, creases, corners. The rules are in
/// geometry/mesh/feature_lines.hpp, with the function that other filters use as well.

#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"

namespace scanmill {

/// Runs find_features() with the threads and the cancellation of `context`. Warns of triangles without area, of loops
/// that were classified by their length, and of creases that were left out. Throws Error for a mesh without triangles,
/// and as find_features() does. Metrics: those of FeatureCounts, and `noise`.
FeatureLines features(const TriangleMesh& mesh, const FeatureParams& params, Context& context);

}  // namespace scanmill
