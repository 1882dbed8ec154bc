// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Distances between segments and triangles, and whether a ball or a cylinder that moves comes near a mesh.
///
/// A ball that moves along a segment sweeps the points within its radius of the segment; a segment that moves without
/// turning sweeps a parallelogram. No result depends on the processor: only sums, products, quotients and roots are
/// used. Segments may be points and triangles may be segments or points.

#include <array>
#include <functional>

#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

/// Squares of distances; 0 if the two have a point in common. Errors are about 1e-14 of the largest distance between
/// two corners, and about 1e-8 of it between segments that are parallel to within 1e-8.
/// Pre: finite coordinates.
/// Source: Ericson, Real-Time Collision Detection (2005), sections 5.1.9 and 5.1.10. Where two segments are nearest,
/// either both nearest points are inside them, or one is an end; two triangles that do not meet are nearest at an edge
/// of one of them.
double squared_distance_of_segments(const std::array<Vec3, 2>& one, const std::array<Vec3, 2>& other);
double squared_distance(const std::array<Vec3, 2>& segment, const std::array<Vec3, 3>& triangle);
double squared_distance(const std::array<Vec3, 3>& one, const std::array<Vec3, 3>& other);

/// Which triangles of a tree count, by slot; all if empty.
using CountsTriangle = std::function<bool(u32 slot)>;

/// Whether a triangle that counts is nearer than `distance` to the segment: whether a ball of that radius meets the
/// mesh on its way from one end to the other.
bool is_nearer(const TriangleTree& mesh, const std::array<Vec3, 2>& segment, double distance,
               const CountsTriangle& counts = {});
/// The same for a triangle.
bool is_nearer(const TriangleTree& mesh, const std::array<Vec3, 3>& triangle, double distance,
               const CountsTriangle& counts = {});
/// The same for the parallelogram that a segment sweeps if it moves by `motion`.
bool is_nearer_when_moved(const TriangleTree& mesh, const std::array<Vec3, 2>& segment, const Vec3& motion,
                          double distance, const CountsTriangle& counts = {});

}  // namespace scanmill
