// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The distance from a point to one triangle, in doubles, for triangles of any shape.
///
/// A triangle is the convex hull of its corners, so it may be a segment or a point. No result depends on the processor:
/// only sums, products, quotients and roots are used.

#include "scanmill/data/frame.hpp"

namespace scanmill {

/// The point of triangle a b c nearest to `point`.
///
/// Pre: finite coordinates.
/// Post: the result is a convex combination of the corners, rounded. So the distance to it is an upper bound, apart
/// from rounding. For triangles of any shape, the error is about 1e-14 of the longest edge plus 1e-14 of the distance
/// to the triangle.
/// Source: Ericson, Real-Time Collision Detection (2005), section 5.1.5. For thin triangles: the nearest point of the
/// three edges and of the face, in coordinates along the longest edge and perpendicular to it.
Vec3 nearest_on_triangle(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c);

/// The point of segment a b nearest to `point`. Pre and post: as for nearest_on_triangle().
Vec3 nearest_on_segment(const Vec3& point, const Vec3& a, const Vec3& b);

}  // namespace scanmill
