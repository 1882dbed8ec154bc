// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Bounding boxes of positions, and the origin that keeps distant coordinates exact.

#include <limits>
#include <span>

#include "scanmill/data/frame.hpp"

namespace scanmill {

/// Componentwise bounds of the finite positions; empty() when there are none.
struct BoundingBox {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = Vec3::Constant(-std::numeric_limits<double>::infinity());

    bool empty() const { return !(low.array() <= high.array()).all(); }
    /// Length of the diagonal; 0 when empty.
    double diagonal() const { return empty() ? 0 : (high - low).stableNorm(); }
};
BoundingBox bounding_box(std::span<const Vec3> positions);

/// Sides of the box of a scan, in its own unit, for which squares and cubes of all lengths in it have all their digits.
inline constexpr double least_side = 1e-9, largest_side = 1e9;
/// Throws Error with the box's range when its longest side is above largest_side, or above 0 and below least_side.
/// Scans are checked once, where they are read; algorithms rely on it.
void require_supported_range(const BoundingBox& box);

/// A good origin for world positions inside `box`: along every axis whose coordinates are large against the diagonal, a
/// coarse power-of-two multiple near the middle, else 0. Chosen so that p - origin, and origin + (p - origin), are
/// exact in double for every p in the box. Zero for a box without points or with an infinite bound.
Vec3 distant_origin(const BoundingBox& box);

struct FiniteBounds {
    /// Means something only when all are finite; empty without positions.
    BoundingBox box;
    bool finite = true;

    /// These positions as well.
    void add(const FiniteBounds& more);
    /// Whether all are finite and in the box.
    bool are_within(const BoundingBox& outer) const;
};

/// O(n), about as fast as memory is read.
FiniteBounds finite_bounds(std::span<const Vec3> positions);

}  // namespace scanmill
