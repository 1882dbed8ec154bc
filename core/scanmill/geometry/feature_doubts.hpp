// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What find_features() could not tell of a mesh, in words, for whoever calls it.

#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/feature_lines.hpp"

namespace scanmill {

/// Warns of triangles without area, and of boundary loops that had to be told apart by their length.
void warn_of_doubts(const FeatureCounts& counts, Context& context);

}  // namespace scanmill
