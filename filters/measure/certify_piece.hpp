// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A part of a triangle, a triangle itself, with bounds of its largest distance to the other surface.

#include <array>

#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::measuring {

/// A corner with its nearest triangle of the other surface, as a place in its tree; `none` while nobody has asked.
struct PieceCorner {
    Vec3 position;
    u32 nearest = NearestTriangle::none;
    double distance = 0;
};

struct Piece {
    std::array<PieceCorner, 3> corners;
    const TriangleTree* other = nullptr;
    /// No point of the piece is farther from the other surface.
    double upper = std::numeric_limits<double>::infinity();
    /// The triangle that `upper` was measured to, and the one nearest to the piece's centre.
    u32 bounding = NearestTriangle::none, under = NearestTriangle::none;
    /// The largest distance seen at a point of the piece that was asked for.
    double seen = 0;
};

/// Lowers `upper` as far as is needed to know whether the piece is below `enough`: first by triangles already known,
/// then by those nearest to the centre and to the corners.
void bound(Piece& piece, double enough);

/// Two or three bounded pieces that together are this one.
///
/// Where the piece reaches over an edge of the triangle under its centre, it is cut along that edge (by the plane
/// through it, perpendicular to that triangle), else across its longest edge. Over one triangle alone the distance is
/// convex and its corners bound it; so surfaces that run side by side need cuts along their edges only.
struct Cut {
    std::array<Piece, 3> pieces;
    std::size_t count = 0;
};
Cut cut(const Piece& piece, double enough);

}  // namespace scanmill::measuring
