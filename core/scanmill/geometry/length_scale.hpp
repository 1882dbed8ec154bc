// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The two lengths that relative parameters refer to: the bounding box's diagonal and the spacing of the samples.

#include "scanmill/data/value.hpp"
#include "scanmill/filter/quantity.hpp"

namespace scanmill {

/// Median distance from a point to the nearest other point; duplicates are at distance 0. Clouds of more than 100,000
/// points are asked at 100,000 of them (the search still sees all), chosen by a hash of their coordinates, so that the
/// order of the points does not matter. 0 for fewer than two points. Non-finite points are passed over.
/// Cost: a sort and a kd-tree, O(n log n).
double point_spacing(std::span<const Vec3> positions);

/// Median edge length over the mesh's edges, each counted once per triangle that has it; 0 without triangles.
/// Edges of non-finite vertices are passed over.
double edge_spacing(const TriangleMesh& mesh);

/// What `%diag` and `spacing` mean for this value. The diagonal is that of all its positions, of a mesh those that its
/// triangles use; the spacing of points is by point_spacing, of meshes by edge_spacing, of everything else by its
/// positions. Both are computed at most once, on demand. Metrics know the diagonal that they report, no spacing.
LengthScale length_scale(const Value& value);

class PointStream;
/// The same of a scan that is streamed. Its spacing would take all points: whoever asks gets an Error.
LengthScale length_scale(const PointStream& scan);

}  // namespace scanmill
