// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Predicates in exact arithmetic, for what rounded arithmetic leaves undecided.

#include <array>

#include "scanmill/data/frame.hpp"

namespace scanmill::exact {

/// A triangle. Pointers, because copies of the corners would cost more than most tests.
using Corners = std::array<const Vec3*, 3>;

bool collinear(const Corners& triangle);

/// triangles_intersect() of triangles whose first `common` corners are the same. Pre: neither is collinear.
bool triangles_intersect(const Corners& one, const Corners& other, std::size_t common);

/// How the triangle crosses the ray from `point` along this axis (0, 1, 2), in its positive direction if `is_upward`:
/// +1 or -1 by the side that it turns to positive coordinates, 0 for not at all.
///
/// The ray is moved sideways by an infinitesimal amount, the same for all triangles, so it meets no edge and no corner:
/// the sum over a closed surface is the surface's winding number around the point, times -1 for one of the directions.
/// Pre: the point is not on the triangle.
int crossing(const Vec3& point, int axis, bool is_upward, const Corners& triangle);

}  // namespace scanmill::exact
