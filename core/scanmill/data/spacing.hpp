// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The typical distance between the samples of a scan, for points and for meshes. Lengths in `spacing` are multiples of
/// it.

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill {

/// Median distance from a point to the nearest other point; duplicates are at distance 0. Returns 0 for fewer than two
/// points. Points that are not finite are ignored. Above 100,000 points the result is the median over a sample of
/// 100,000 points, each of which searches among all points. A hash of the coordinates chooses the sample, so the order
/// of the points does not matter. Cost: O(n log n).
double point_spacing(std::span<const Vec3> positions);

/// Median edge length; an edge counts once per triangle. 0 without triangles. Edges with a vertex that is not finite
/// are ignored.
double edge_spacing(const TriangleMesh& mesh);

}  // namespace scanmill
