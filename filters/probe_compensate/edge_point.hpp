// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The point of an edge that two balls touch, and the correction of such points on curved edges.

#include <optional>
#include <span>
#include <vector>

#include "scanmill/data/features.hpp"

namespace scanmill::compensating {

/// Two balls that touch one edge.
struct BallPair {
    Vec3 first, second;  ///< centres
    Vec3 tangent;  ///< unit vector along the edge: the normal of the plane in which the balls have moved
    Vec3 approach;  ///< unit vector from the part to the probe, the mean of both
};

struct EdgePoint {
    Vec3 position;
    double sine;  ///< the angle is that between the contact normals
    Vec3 first_normal, second_normal;  ///< from the point to the centres, projected; of length r
};

/// The centres are projected along the tangent into the plane through their mean. Returns the intersection of the
/// circles of this radius round them that is away from the approach; empty if they do not meet, or fix no point: the
/// sine is below 1e-3, or the centres lie along the approach.
std::optional<EdgePoint> edge_point(const BallPair& pair, double radius);

/// A point of a line; `pair` is null for a point of one touch.
struct LinePosition {
    const BallPair* pair;
    EdgePoint* point;
};

/// Corrects the points of one line where the edge is curved. The plan's tangent is that of a scanned edge. If it is off
/// by an angle epsilon, the balls touch a curved edge beside the plane across it, and the point is off by about (r sin
/// epsilon)² / 2 r.
///
/// The circle through a point and its neighbours stands for the edge. Turning the centres about its axis into the plane
/// through the axis and the point leaves their distance from the edge as it is, and edge_point() is exact there. The
/// circles change with the points, so this is repeated until no point moves by more than 1e-9 radii, at most 20 times.
/// Neighbours are the nearest points of the line that are at least a radius away, if the line is long enough.
/// A point stays as it is unless it and two neighbours on each side are pairs, and all five are on one circle within
/// a quarter of the distance between touches, so points beside corners stay. `closed`: the line returns to its first
/// point.
/// Returns the number of corrected points.
std::size_t correct_curved(std::span<const LinePosition> line, bool closed, double radius);

}  // namespace scanmill::compensating
