// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Signs that a surface made from points differs from the surface of the scanned object.

#include <string>
#include <vector>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// The share of the surface's area in triangles with an edge longer than `edges` times the median edge
/// (edge_spacing()). 0 for a surface without area. Cost: O(n). Pre: finite positions.
double spanned_share(const TriangleMesh& mesh, double edges);

/// Among the edges with two triangles, the share with a dihedral deviation above 60 degrees. 0 if there is no such
/// edge. Cost: O(n). Pre: the mesh is valid input of topology().
double rough_share(const TriangleMesh& mesh);

/// Returns a sentence for each of these signs that the surface has:
/// - spanned_share(mesh, 7) is above a tenth. Surfaces of complete scans reach 0.06 (the merged bunny, across the holes
///   of its base). The share is 0.11 to 0.6 where a scan lacks a side, or where a few distant points decide the
///   surface.
/// - If the first sign is absent: spanned_share(mesh, 4) is above a thousandth, and the genus is above 0. A handle may
///   be a bridge over a gap, and a filled tunnel lies in a gap. Among the scans of bench/quality/raw-scans.md, correct
///   surfaces have no edge as long as four median edges. Surfaces of wrong genus have an edge of six or more.
/// - rough_share() is above 0.15, on more than 10,000 edges. With fewer edges, coarse sampling looks the same. Surfaces
///   of clean scans reach 0.02, and surfaces of raw overlapping views 0.08. Surfaces crumpled by outliers, or by noise
///   as large as the spacing, have 0.18 to 0.3.
/// - `noise` turns a triangle with edges of the median length by more than 5 degrees. `noise` is the standard deviation
///   of the vertices, see vertex_noise(). Scans of the usual collections have 0 to 4 degrees.
///
/// Its callers declare signs_of_doubtful_surface.
std::vector<std::string> doubts_about_surface(const TriangleMesh& mesh, double noise = 0);
inline constexpr const char* signs_of_doubtful_surface =
    "the surface spans gaps (more than 10 % of its area has an edge longer than seven median edges, or it has a handle "
    "beside a gap) or is rough (at more than 15 % of more than 10,000 edges it turns by more than 60 degrees)";

}  // namespace scanmill
