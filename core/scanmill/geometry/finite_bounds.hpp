// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The bounds of positions and whether they are finite, in one pass over memory.

#include <span>

#include "scanmill/data/points.hpp"

namespace scanmill {

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
