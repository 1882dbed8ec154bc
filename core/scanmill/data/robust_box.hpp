// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The box of a scan without its stray points: the box that `%diag` of points refers to.
///
/// Let k = floor(n / 500) for n points, [a, b] the box between the (k+1)-th lowest and the (k+1)-th highest coordinate
/// of each axis, and Q the box [a, b] widened on every side by a quarter of its diagonal. If at most k points are
/// outside Q, these points are stray; if there are more, no point is stray. The robust box is the box of all points
/// that are not stray. Positions with a NaN or an infinity are ignored.

#include <functional>
#include <span>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/bounds.hpp"

namespace scanmill {

struct StrayPoint {
    u32 row;
    Vec3 position;
    bool operator==(const StrayPoint&) const = default;
};

struct RobustBox {
    RobustBox() = default;
    /// The box of a scan without stray points.
    RobustBox(const BoundingBox& box) : all(box), robust(box) {}

    BoundingBox all;                ///< the box of all finite positions
    BoundingBox robust;             ///< the box of the positions that are not stray
    std::vector<StrayPoint> stray;  ///< in the order of their rows

    /// The diagonal of the robust box; 0 if empty.
    double diagonal() const { return robust.diagonal(); }
};

/// Positions that can be read piece by piece, each piece as often as needed.
struct PositionPieces {
    /// The index of the first position of every piece; at the end, the number of positions.
    std::span<const std::size_t> begin;
    /// The positions of a piece. May fill and return `buffer`.
    std::function<std::span<const Vec3>(std::size_t piece, Array<Vec3>& buffer)> read;
};

/// Pre: `all` is the bounding_box() of the positions.
/// Cost: reads pieces until they prove that no point is stray. Few pieces suffice if many points are near every side of
/// `all`. Without a proof, one more pass follows: a few dozen nanoseconds per position, and at most 192 bytes per 500
/// positions.
RobustBox robust_box(const PositionPieces& pieces, const BoundingBox& all);
RobustBox robust_box(std::span<const Vec3> positions, const BoundingBox& all);
inline RobustBox robust_box(std::span<const Vec3> positions) { return robust_box(positions, bounding_box(positions)); }

/// A good origin for the world positions of a scan, with origin + (p - origin) equal to p for every point p. It is
/// distant_origin() of the robust box. If a stray point would lose a bit, it is distant_origin() of the box of all
/// points.
Vec3 distant_origin(const RobustBox& box);

}  // namespace scanmill
