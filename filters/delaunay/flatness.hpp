// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Is a cloud spatial: does it have a thickness that its coordinates can express?
///
/// A plate that was scanned, rotated and stored is flat only up to the last bits of its coordinates. Exact predicates
/// would take those bits for a shape and fill the plate with cells of pure rounding noise; so clouds within a few units
/// in the last place of one plane are refused like exactly flat ones. "Last place" counts the distance from the world's
/// origin, because that is where the coordinates were rounded.

#include <span>

#include "scanmill/data/frame.hpp"

namespace scanmill {

/// How far points stray from the simplest shapes that pass near them, in the unit of the coordinates. Each is at most a
/// small factor above the least possible one.
struct Extents {
    double from_point = 0, from_line = 0, from_plane = 0;
    /// What the coordinates' last places can express.
    double rounding = 0;
};

/// Pre: finite positions, at least one. Cost: four passes. Deterministic for any number of threads.
Extents extents(std::span<const Vec3> positions, const Vec3& origin, unsigned threads);

/// Throws Error for fewer than 4 distinct points and for points within rounding of one place, line or plane.
void require_spatial(std::span<const Vec3> positions, const Frame& frame, unsigned threads);

/// Throws the Error for points that span only `dimension` < 3 and stray up to `distance` from such a shape.
[[noreturn]] void refuse_flat(std::span<const Vec3> positions, int dimension, double distance, const Frame& frame);

}  // namespace scanmill
