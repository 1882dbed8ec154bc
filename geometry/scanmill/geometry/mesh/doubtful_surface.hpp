// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Signs that a surface that was made from points is not that of the scanned object.

#include <string>
#include <vector>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// The share of the surface's area in triangles with an edge longer than `edges` times the median edge
/// (edge_spacing()). 0 without area. Cost: O(n). Pre: finite positions.
double spanned_share(const TriangleMesh& mesh, double edges);

/// The share of the edges with a dihedral deviation above 60 degrees, of those with two triangles. 0 without any.
/// Cost: O(n). Pre: as topology().
double rough_share(const TriangleMesh& mesh);

/// A sentence for each sign that this surface has:
/// - spanned_share() of seven edges is above a tenth. Surfaces of complete scans reach 0.06 (the merged bunny, across
/// the holes of its
///   base); those of scans that lack a side, or of which a few distant points decide, have 0.11 to 0.6.
/// - spanned_share() of four edges is above a thousandth, and the genus is not 0: a handle may be a bridge over a gap,
///   and a filled tunnel lies in one. Among the scans of bench/quality/raw-scans.md, right surfaces have no edge
///   of four medians, and those of wrong genus have one of six or more.
/// - rough_share() is above 0.15, on more than 10,000 edges: of few points, coarse sampling looks the same. Surfaces of
///   clean scans reach 0.02, of raw overlapping views 0.08; crumpled ones, through outliers or noise as large as the
///   spacing, have 0.18 to 0.3.
/// - `noise`, the standard deviation of its vertices by vertex_noise(), turns a triangle with edges of the median
///   length by more than 5 degrees. Scans of the usual collections have 0 to 4 degrees.
std::vector<std::string> doubts_about_surface(const TriangleMesh& mesh, double noise = 0);

}  // namespace scanmill
