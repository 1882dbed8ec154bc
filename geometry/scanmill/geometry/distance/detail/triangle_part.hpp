// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Parts of triangles with bounds of their distance to another surface, and how they are cut.

#include <array>

#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::triangle_parts {

/// A corner with its nearest triangle of the other surface, as NearestTriangle::slot; `none` until it is computed.
struct PartCorner {
    Vec3 position;
    u32 nearest = NearestTriangle::none;
};

/// A part of a triangle, or the whole, with bounds of its largest distance to the other surface.
struct TrianglePart {
    std::array<PartCorner, 3> corners;
    const TriangleTree* other = nullptr;
    /// No point of the part is farther from the other surface.
    double upper = std::numeric_limits<double>::infinity();
    /// The triangle that `upper` was measured to, and the one nearest to the part's centre.
    u32 bounding = NearestTriangle::none, below = NearestTriangle::none;
    /// The largest distance computed at a point of the part.
    double seen = 0;
};

/// Lowers `upper` until it is at most `enough`, or as far as it can, by triangles already known.
void bound_by_known(TrianglePart& part, double enough);
/// The same by triangles already known, and by those nearest to the centre and to the corners.
void bound(TrianglePart& part, double enough);

/// Two or three bounded parts whose union is the part that was cut.
///
/// If the part crosses an edge of the triangle below its centre, it is cut along that edge (by the plane through it,
/// perpendicular to that triangle), else across its own longest edge. Over a single triangle the distance is convex and
/// its corners bound it; so nearly parallel surfaces need cuts along their edges only.
struct Cut {
    std::array<TrianglePart, 3> parts;
    std::size_t count = 0;
};
Cut cut(const TrianglePart& part, double enough);

}  // namespace scanmill::triangle_parts
