// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How far samples lie apart: what `spacing` means for points and for meshes, of any finite coordinates.

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill {

/// Median distance from a point to the nearest other point; duplicates are at distance 0. Clouds of more than 100,000
/// points are asked at 100,000 of them (the search still sees all), chosen by a hash of their coordinates, so that the
/// order of the points does not matter. 0 for fewer than two points, infinity where the median distance is larger than
/// any double. Non-finite points are passed over.
/// Cost: a sort and a kd-tree, O(n log n); a second, slower one where squared distances are no numbers.
double point_spacing(std::span<const Vec3> positions);

/// Median edge length over the mesh's edges, each counted once per triangle that has it; 0 without triangles, infinity
/// where the median is larger than any double. Edges of non-finite vertices are passed over.
double edge_spacing(const TriangleMesh& mesh);

}  // namespace scanmill
