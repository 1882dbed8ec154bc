// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What the filter says of its result: metrics, and warnings of what the result does not show.

#include "region_grow/region_grow.hpp"
#include "region_grow/surface.hpp"
#include "region_grow/thin_parts.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"

namespace scanmill::growing {

/// Metrics as plugin.cpp declares them, except `known-bins`. Warns when more than half a percent of the places
/// are unused, of what find_features() could not tell, of loops at thin parts, and
/// of ends that only the signs of given normals make.
void report(const RegionGrowResult& result, const FeatureCounts& lines, const Surface& surface, const ThinParts& thin,
            Context& context);

}  // namespace scanmill::growing
