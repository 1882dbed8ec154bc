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

}  // namespace scanmill::exact
