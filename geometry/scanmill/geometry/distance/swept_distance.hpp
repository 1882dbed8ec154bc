// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Distances between segments and triangles, and tests whether a moving ball or cylinder comes near a mesh.
///
/// A ball that moves along a segment sweeps all points within its radius of the segment. A segment that moves without
/// turning sweeps a parallelogram. No result depends on the processor: only sums, products, quotients and roots are
/// used. Segments may be points, and triangles may be segments or points.

#include <array>
#include <functional>

#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

/// Squared distances; 0 if the two have a point in common. Errors are about 1e-14 of the largest distance between two
/// corners. Between segments that are parallel to within 1e-8, errors are about 1e-8 of that distance.
/// Pre: finite coordinates.
/// Source: Ericson, Real-Time Collision Detection (2005), sections 5.1.9 and 5.1.10. The nearest points of two segments
/// are both inside the segments, or one of them is an end. Two triangles that do not meet are nearest at an edge of one
/// of them.
double squared_distance_of_segments(const std::array<Vec3, 2>& one, const std::array<Vec3, 2>& other);
double squared_distance(const std::array<Vec3, 2>& segment, const std::array<Vec3, 3>& triangle);
double squared_distance(const std::array<Vec3, 3>& one, const std::array<Vec3, 3>& other);

/// Selects the triangles of a tree that count, by slot. If empty, all triangles count.
using CountsTriangle = std::function<bool(u32 slot)>;

/// Whether a triangle that counts is nearer than `distance` to the segment. In other words: whether a ball with this
/// radius meets the mesh while it moves from one end of the segment to the other.
bool is_nearer(const TriangleTree& mesh, const std::array<Vec3, 2>& segment, double distance,
               const CountsTriangle& counts = {});
/// Whether a triangle that counts is nearer than `distance` to `triangle`.
bool is_nearer(const TriangleTree& mesh, const std::array<Vec3, 3>& triangle, double distance,
               const CountsTriangle& counts = {});
/// Whether a triangle that counts is nearer than `distance` to the parallelogram that the segment sweeps when it moves
/// by `motion`.
bool is_nearer_when_moved(const TriangleTree& mesh, const std::array<Vec3, 2>& segment, const Vec3& motion,
                          double distance, const CountsTriangle& counts = {});

}  // namespace scanmill
