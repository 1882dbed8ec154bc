// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The box of a scan without its stray points: the box that `%diag` of points refers to.
///
/// Let k = floor(n / 500) for n points, [a, b] the box between the (k+1)-th lowest and the (k+1)-th highest coordinate
/// of each axis, and Q the box [a, b] widened on every side by a quarter of its diagonal. Points outside Q are stray
/// if there are at most k of them; with more, none is. The robust box is that of the points that are not stray.
/// Positions with a NaN or an infinity are ignored. Without stray points the robust box is the box of all points.

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
    /// A box without stray points.
    RobustBox(const BoundingBox& box) : all(box), robust(box) {}

    BoundingBox all;                ///< of all finite positions
    BoundingBox robust;             ///< of those that are not stray
    std::vector<StrayPoint> stray;  ///< in the order of their rows

    /// The diagonal of the robust box; 0 if empty.
    double diagonal() const { return robust.diagonal(); }
};

/// Positions that can be read piece by piece, each piece as often as needed.
struct PositionPieces {
    /// The first position of every piece, and the number of positions.
    std::span<const std::size_t> begin;
    /// The positions of a piece. May fill and return `buffer`.
    std::function<std::span<const Vec3>(std::size_t piece, Array<Vec3>& buffer)> read;
};

/// `all` is the bounding_box() of the positions.
/// Cost: some pieces, as many as show that no point is stray: few if many points are near every side of `all`. If they
/// do not show it, one pass, a few dozen nanoseconds per position, with at most 192 bytes per 500 positions.
RobustBox robust_box(const PositionPieces& pieces, const BoundingBox& all);
RobustBox robust_box(std::span<const Vec3> positions, const BoundingBox& all);
inline RobustBox robust_box(std::span<const Vec3> positions) { return robust_box(positions, bounding_box(positions)); }

/// A good origin for the world positions of a scan: distant_origin() of the robust box, or, if a stray point would lose
/// a bit relative to it, that of the box of all points. So origin + (p - origin) is exactly p for all of them.
Vec3 distant_origin(const RobustBox& box);

}  // namespace scanmill
