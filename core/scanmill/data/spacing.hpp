// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The distance between samples, which `spacing` refers to, for points and for meshes.

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill {

/// Median distance from a point to the nearest other point; duplicates are at distance 0. Above 100,000 points it is
/// the median over a sample of 100,000 (each searches among all points), chosen by a hash of the coordinates, so the
/// order of the points does not matter. 0 for fewer than two points. Non-finite points are ignored. Cost: O(n log n).
double point_spacing(std::span<const Vec3> positions);

/// Median edge length; an edge counts once per triangle. 0 without triangles. Edges of non-finite vertices are ignored.
double edge_spacing(const TriangleMesh& mesh);

}  // namespace scanmill
