// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether a new triangle would overlap the surface, projected along a normal.
///
/// Two triangles with a common corner overlap when their sectors at that corner do. Any other overlap of a triangle
/// that continues the boundary begins where the boundary crosses one of its two new edges. Signs are exact for the
/// coordinates as they are, so collinear points, as in grids, are collinear in every test.

#include <Eigen/Geometry>

#include "scanmill/geometry/growing/surface.hpp"

namespace scanmill::growing {

int exact_side_of(const Surface& surface, u32 a, u32 b, u32 c, const Vec3& axis);

/// The side of line a → b on which c lies, seen against the unit vector `axis`: +1 left, −1 right, 0 on it. Exact;
/// computed in doubles where rounding cannot change the sign.
inline int side_of(const Surface& surface, u32 a, u32 b, u32 c, const Vec3& axis) {
    const auto& p = surface.positions;
    const Vec3 u = p[b] - p[a], w = p[c] - p[a];
    const double volume = axis.dot(u.cross(w));
    // Far above the rounding error of these dozen operations.
    const double error_bound = 1e-14 * (u.cwiseAbs().sum() * w.cwiseAbs().sum());
    return volume > error_bound ? 1 : volume < -error_bound ? -1 : exact_side_of(surface, a, b, c, axis);
}

/// Whether the sector from first to last, counter-clockwise around `vertex` seen against `axis`, is narrower than 180
/// degrees and does not overlap the triangles there; common edges are allowed.
bool sector_is_free(const Surface& surface, u32 vertex, u32 first, u32 last, const Vec3& axis);

/// The direction of the summed unit normals of the vertex's triangles, and of `more`; zero where the sum is.
Vec3 fan_normal(const Surface& surface, u32 vertex, const Vec3& more);

/// Whether sector_is_free() at every corner of the triangle that is a vertex of the surface. `normal`: the triangle's.
/// A corner's axis is its point's normal or, with `along_fans`, fan_normal() with the triangle's normal. Along the fans
/// the test holds where the point's normal does not fit the surface, as at edges and tips, and takes longer.
bool sectors_are_free(const Surface& surface, const Triangle& triangle, const Vec3& normal, bool along_fans);

/// Whether the closed triangle contains the point, projected along the normal.
bool contains(const Surface& surface, const Triangle& triangle, const Vec3& normal, u32 point);

/// Whether one of the boundary edges that leave `vertex` crosses or touches a → d or d → b, projected along `normal`,
/// and has an end within `height` of the triangle's plane or ends on both sides of it. Edges that end in a, d or b
/// never do.
bool boundary_crosses(const Surface& surface, u32 vertex, u32 a, u32 d, u32 b, const Vec3& normal, double height);

}  // namespace scanmill::growing
