// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// An order in which consecutive points are near each other. Searches in this order find the memory of the previous
/// search in the cache, and its result is a good hint.

#include <span>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// The rows of the positions along the Morton curve through their bounding box, cut into 2^21 steps per axis. Positions
/// with equal codes are sorted by row. Pre: finite positions, fewer than 2^32. Cost: O(n) time, 32 bytes per point
/// during the call.
Array<u32> spatial_order(std::span<const Vec3> positions);

}  // namespace scanmill
