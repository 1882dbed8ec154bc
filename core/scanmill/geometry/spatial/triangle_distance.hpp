// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The distance from a point to one triangle, in doubles, for triangles of any shape.
///
/// A triangle is the convex hull of its corners: one whose corners lie on a line is a segment, one whose corners are
/// equal is a point. No result depends on the processor: only additions, products, quotients and roots are used.

#include "scanmill/data/frame.hpp"

namespace scanmill {

/// The point of triangle a b c nearest to `point`.
///
/// Pre: finite coordinates whose fourth powers are numbers (about 1e-70 to 1e70 apart).
/// Post: a convex combination of the corners, rounded; so a distance measured to it errs upwards, apart from rounding.
/// Of triangles of any shape it is the nearest point up to about 1e-14 of the longest edge and of the way from the
/// point to the triangle. Source: Ericson, Real-Time Collision Detection (2005), section 5.1.5; thin triangles as their
/// segments and their face, along the longest edge and across.
Vec3 nearest_on_triangle(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c);

/// Of the segment a b. Pre and post as above.
Vec3 nearest_on_segment(const Vec3& point, const Vec3& a, const Vec3& b);

}  // namespace scanmill
