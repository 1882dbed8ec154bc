// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether a new triangle would lie over what is there, decided in the plane that the surface faces along.
///
/// Of two triangles with a common corner it is the sectors at that corner that must not overlap; any other overlap of a
/// triangle that stands on the border begins where the border crosses its two new edges. Signs are exact for the
/// coordinates as they are, so points on one line (grids) are on one line in every question.

#include <Eigen/Geometry>

#include "region_grow/surface.hpp"

namespace scanmill::growing {

int exact_side_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& axis, double axis_length);

/// On which side of the line a → b, seen against `axis`, lies c: +1 left, −1 right, 0 on it. Exact; where rounding
/// cannot change the sign, in doubles. `axis_length`: that of the surface.
inline int side_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& axis, double axis_length) {
    const Vec3 u = b - a, w = c - a;
    const double volume = axis.dot(u.cross(w));
    // Far above what rounding of these dozen operations can amount to; axes are of unit length.
    const double doubt = 1e-14 * (u.cwiseAbs().sum() * w.cwiseAbs().sum());
    return volume > doubt ? 1 : volume < -doubt ? -1 : exact_side_of(a, b, c, axis, axis_length);
}

/// Whether the sector from first to last, counter-clockwise round `vertex` seen against `axis`, is narrower than a half
/// turn and free of the sectors and edges of the triangles there; common edges are free.
bool sector_is_free(const Surface& surface, u32 vertex, u32 first, u32 last, const Vec3& axis);

/// Whether x lies in the closed triangle a b c, seen along its normal.
bool lies_over(const Surface& surface, const Triangle& triangle, const Vec3& normal, u32 x);

/// Whether one of the edges that bound the surface at `vertex` and leave it crosses or touches a → d or d → b, seen
/// along `normal`, on the same sheet: facing the same way and no farther off than `height`. Edges with a corner among
/// the three never do.
bool border_crosses(const Surface& surface, u32 vertex, u32 a, u32 d, u32 b, const Vec3& normal, double height);

}  // namespace scanmill::growing
