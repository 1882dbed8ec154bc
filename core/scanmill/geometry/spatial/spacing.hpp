// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The distance between samples: what `spacing` means for points and for meshes.

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill {

/// Median distance from a point to the nearest other point; duplicates are at distance 0. Clouds of more than 100,000
/// points are asked at 100,000 of them (the search still sees all), chosen by a hash of their coordinates, so that the
/// order of the points does not matter. 0 for fewer than two points. Non-finite points are ignored.
/// Pre: within the supported range, so that squared distances are numbers. Cost: a kd-tree, O(n log n).
double point_spacing(std::span<const Vec3> positions);

/// Median edge length over the mesh's edges, each counted once per triangle that has it; 0 without triangles.
/// Edges of non-finite vertices are ignored.
double edge_spacing(const TriangleMesh& mesh);

}  // namespace scanmill
