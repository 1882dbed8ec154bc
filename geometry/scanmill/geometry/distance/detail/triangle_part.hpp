// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Parts of triangles with bounds of their distance to another surface, and functions that bound and cut them.

#include <array>

#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::triangle_parts {

/// A corner with its nearest triangle of the other surface, as NearestTriangle::slot; `none` if not computed yet.
struct PartCorner {
    Vec3 position;
    u32 nearest = NearestTriangle::none;
};

/// A part of a triangle, or the whole, with bounds of its largest distance to the other surface.
struct TrianglePart {
    std::array<PartCorner, 3> corners;
    const TriangleTree* other = nullptr;
    /// Upper bound: no point of the part is farther from the other surface.
    double upper = std::numeric_limits<double>::infinity();
    /// `bounding`: the triangle to which `upper` was measured. `below`: the triangle nearest to the part's centre.
    u32 bounding = NearestTriangle::none, below = NearestTriangle::none;
    /// The largest distance computed at a point of the part.
    double seen = 0;
};

/// Lowers `upper` with the triangles already known; stops when it is at most `enough`.
void bound_by_known(TrianglePart& part, double enough);
/// Lowers `upper` with the triangles already known, then with those nearest to the centre and to the corners; stops
/// when it is at most `enough`.
void bound(TrianglePart& part, double enough);

/// Two or three bounded parts whose union is the part that was cut.
///
/// If the part crosses an edge of the triangle below its centre, it is cut by the plane through this edge,
/// perpendicular to that triangle. Otherwise it is cut across its own longest edge. Over a single triangle the distance
/// is convex, so the corners of a part bound it. Nearly parallel surfaces therefore need cuts along edges only.
struct Cut {
    std::array<TrianglePart, 3> parts;
    std::size_t count = 0;
};
Cut cut(const TrianglePart& part, double enough);

}  // namespace scanmill::triangle_parts
