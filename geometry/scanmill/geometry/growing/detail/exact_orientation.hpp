// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The orientation of four points in exact arithmetic, for what rounded arithmetic leaves undecided.

#include "scanmill/data/frame.hpp"

namespace scanmill::exact {

/// +1 if d is above the plane of a, b, c, from where they are counter-clockwise; −1 below; 0 on it.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace scanmill::exact
