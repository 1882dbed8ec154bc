// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether a cloud is spatial: whether it has a thickness that its coordinates can express.
///
/// A plate that was scanned, rotated and stored is flat only up to the last bits of its coordinates. Exact predicates
/// would treat those bits as a shape and fill the plate with cells of rounding noise. So a cloud is refused as flat if
/// it is within a few units in the last place of one plane. The unit in the last place includes the distance from the
/// world's origin, because the coordinates were rounded there.

#include <span>

#include "scanmill/data/frame.hpp"

namespace scanmill {

/// Largest distances of the points from one position, one line and one plane that are near all points, in the unit of
/// the coordinates. Each is at most a small factor above the least possible one.
struct Extents {
    double from_point = 0, from_line = 0, from_plane = 0;
    /// The smallest distance that the coordinates can express.
    double rounding = 0;
};

/// `origin`: the frame's. Pre: finite positions, at least one. Cost: four passes. Deterministic for any number of
/// threads.
Extents extents(std::span<const Vec3> positions, const Vec3& origin, unsigned threads);

/// Throws Error for fewer than 4 distinct points and for points within rounding of one position, line or plane.
void require_spatial(std::span<const Vec3> positions, const Frame& frame, unsigned threads);

/// Throws the Error for points that all lie within `distance` of one position, line or plane (`dimension` 0, 1 or 2).
[[noreturn]] void refuse_flat(std::span<const Vec3> positions, int dimension, double distance, const Frame& frame);

}  // namespace scanmill
