// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Predicates in exact arithmetic, for cases that rounded arithmetic cannot decide.

#include <array>

#include "scanmill/data/frame.hpp"

namespace scanmill::exact {

/// A triangle, by pointers to its corners: copies of the corners would cost more than most tests.
using Corners = std::array<const Vec3*, 3>;

bool collinear(const Corners& triangle);

/// triangles_intersect() for triangles whose first `common` corners are the same. Pre: no triangle is collinear.
bool triangles_intersect(const Corners& one, const Corners& other, std::size_t common);

/// The signed crossing of the triangle with the ray from `point` along the axis (0, 1 or 2). The ray has the positive
/// direction if `is_upward`, else the negative one. The result is 0 if the triangle does not cross the ray. Otherwise
/// it is +1 if the triangle is counter-clockwise seen from the positive end of the axis, -1 if it is clockwise.
///
/// The ray is moved sideways by an infinitesimal amount, the same for all triangles, so it meets no edge and no corner.
/// The sum over a closed surface is the surface's winding number around the point, times -1 for downward rays. Pre: the
/// point is not on the triangle.
int crossing(const Vec3& point, int axis, bool is_upward, const Corners& triangle);

}  // namespace scanmill::exact
