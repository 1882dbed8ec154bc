// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Where a surface that was made from points spans gaps between them.

#include <string>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// The share of the surface's area in triangles with an edge longer than seven times the median edge (edge_spacing()).
/// 0 without area. Cost: O(n). Pre: finite positions.
double spanned_share(const TriangleMesh& mesh);

/// A sentence if spanned_share() is above a tenth, else empty. Surfaces of complete scans reach 0.06 (the merged bunny,
/// across the holes of its base); those of scans that lack a side, or of which a few distant points decide, have 0.11
/// to 0.6.
std::string doubt_about_gaps(const TriangleMesh& mesh);

}  // namespace scanmill
