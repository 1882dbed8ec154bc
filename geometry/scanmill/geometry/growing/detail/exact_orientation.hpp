// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The orientation of four points in exact arithmetic, for cases that rounded arithmetic cannot decide.

#include "scanmill/data/frame.hpp"

namespace scanmill::exact {

/// +1 if d is above the plane of a, b, c; −1 if below; 0 if on it. Above is the side from which a, b, c are
/// counter-clockwise.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace scanmill::exact
