// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Bounding boxes of positions, and the origin that keeps distant coordinates exact.

#include <limits>
#include <span>

#include "scanmill/data/frame.hpp"

namespace scanmill {

/// Componentwise bounds of positions; empty() without positions.
struct BoundingBox {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = Vec3::Constant(-std::numeric_limits<double>::infinity());

    void add(const Vec3& position) {
        low = low.cwiseMin(position);
        high = high.cwiseMax(position);
    }
    bool empty() const { return !(low.array() <= high.array()).all(); }
    /// Length of the diagonal; 0 if empty.
    double diagonal() const { return empty() ? 0 : (high - low).stableNorm(); }
};
/// The smallest box that contains the finite positions.
BoundingBox bounding_box(std::span<const Vec3> positions);

/// Least and largest side of a scan's box that is supported, in the scan's unit. In this range squares and cubes of all
/// lengths keep all their digits.
inline constexpr double least_side = 1e-9, largest_side = 1e9;
/// Whether a side of the box is longer than largest_side.
bool is_too_long(const BoundingBox& box);
/// Throws Error with the box's range if its longest side is above largest_side, or above 0 and below least_side.
/// Every scan is checked once, when it is read; algorithms rely on this check.
void require_supported_range(const BoundingBox& box);

/// The coordinates along an axis are distant if the middle of the box is more than this many diagonals away from zero.
/// Doubles have bits to spare for coordinates that are not distant.
inline constexpr double distant_diagonals = 16;
/// A good origin for the world positions inside `box`. Along an axis with distant coordinates it is a multiple of a
/// large power of two near the middle of the box; along other axes it is 0. p - origin and origin + (p - origin) are
/// exact in double for every p in the box. Zero for a box without points or with an infinite bound.
Vec3 distant_origin(const BoundingBox& box);

struct FiniteBounds {
    /// The bounds of the positions; empty without positions. Unspecified if a coordinate is not finite.
    BoundingBox box;
    bool finite = true;

    /// Extends the bounds by the bounds of more positions.
    void add(const FiniteBounds& more);
    /// Whether all positions are finite and inside `outer`.
    bool are_within(const BoundingBox& outer) const;
};

/// Cost: O(n), about as fast as memory is read.
FiniteBounds finite_bounds(std::span<const Vec3> positions);

}  // namespace scanmill
