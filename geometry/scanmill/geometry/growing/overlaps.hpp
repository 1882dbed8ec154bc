// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether a new triangle would overlap the surface, projected along a normal.
///
/// Two triangles with a common corner overlap if their sectors at this corner overlap. Any other overlap with a
/// triangle that continues the boundary begins where the boundary crosses one of its two new edges. Signs are exact for
/// the coordinates as given. So points on one line of a grid are collinear in every test.

#include <Eigen/Geometry>
#include <span>

#include "scanmill/geometry/growing/surface.hpp"

namespace scanmill::growing {

int exact_side_of(const Surface& surface, u32 a, u32 b, u32 c, const Vec3& axis);

/// The side of line a → b on which c lies, seen against the unit vector `axis`: +1 left, −1 right, 0 on the line. The
/// sign is exact. It is computed in doubles where rounding cannot change it.
inline int side_of(const Surface& surface, u32 a, u32 b, u32 c, const Vec3& axis) {
    const auto& p = surface.positions;
    const Vec3 u = p[b] - p[a], w = p[c] - p[a];
    const double volume = axis.dot(u.cross(w));
    // The bound is far above the rounding error of these dozen operations.
    const double error_bound = 1e-14 * (u.cwiseAbs().sum() * w.cwiseAbs().sum());
    return volume > error_bound ? 1 : volume < -error_bound ? -1 : exact_side_of(surface, a, b, c, axis);
}

/// Whether the sector at `vertex` is free: narrower than 180 degrees, and without overlap with the vertex's triangles.
/// Common edges are allowed. The sector goes counter-clockwise from `first` to `last`, seen against `axis`.
bool sector_is_free(const Surface& surface, u32 vertex, u32 first, u32 last, const Vec3& axis);

/// The unit vector of the sum of `more` and the unit normals of the vertex's triangles; zero if the sum is zero.
Vec3 fan_normal(const Surface& surface, u32 vertex, const Vec3& more);

/// Whether the triangle crosses or covers a part of a fixed edge, projected along the triangle's normal. Only fixed
/// edges at the triangle's corners and at the points `near` are tested. An edge without a common corner counts only if
/// an end is within half the triangle's longest edge of its plane, or if its ends are on two sides of the plane. An
/// edge at a corner counts only if it is less than 64 degrees from the plane. Edges of the triangle do not count.
bool crosses_fixed_edge(const Surface& surface, const Triangle& triangle, const Vec3& normal,
                        std::span<const u32> near);

/// Whether sector_is_free() holds at every corner of the triangle that is a vertex of the surface. `normal`: the
/// triangle's normal. The axis of a corner is its point's normal or, with `along_fans`, fan_normal() with the
/// triangle's normal. The test along the fans is slower, but it is also right where the point's normal does not fit the
/// surface, as at edges and tips. At ends of fixed edges, the axis bisects the triangle's normal and the mean normal of
/// the fan.
bool sectors_are_free(const Surface& surface, const Triangle& triangle, const Vec3& normal, bool along_fans);

/// Whether the closed triangle contains the point, projected along the normal.
bool contains(const Surface& surface, const Triangle& triangle, const Vec3& normal, u32 point);

/// Whether a boundary edge that leaves `vertex` crosses or touches a → d or d → b, projected along `normal`. The edge
/// counts only if an end is within `height` of the triangle's plane, or if its ends are on two sides of the plane.
/// Edges that end in a, d or b do not count.
bool boundary_crosses(const Surface& surface, u32 vertex, u32 a, u32 d, u32 b, const Vec3& normal, double height);

}  // namespace scanmill::growing
