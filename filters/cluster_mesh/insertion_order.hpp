// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The order in which points are inserted: slice after slice, and within a slice by distance.
///
/// Slicing planes are perpendicular to an axis and `slice` apart. The first plane goes through the lowest point. A
/// point belongs to the nearest plane; ties: to the upper one. Points are not projected.
///
/// Source: Sangveraphunsiri, Srirakulchai 2006, section 2.1.

#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/growing/distinct_points.hpp"

namespace scanmill::clustering {

/// For each coordinate, the number of the nearest plane, where plane 0 is at `first`: floor((x - first) / slice + 1/2).
/// Pre: no coordinate is below first - slice / 2, and slice > 0.
Array<u32> slices_of(std::span<const double> coordinates, double first, double slice);

enum class InPlane {
    paper,  ///< by distance to the plane
    nearest  ///< the point nearest to an inserted point comes next
};

/// All points in the order of insertion. `axis` is 0, 1 or 2 for x, y or z. Ties for InPlane::paper: the point that is
/// lower by the two other coordinates in order (y and z, x and z, x and y). Ties for InPlane::nearest: the lower
/// number. If no point of the slice is among the 16 nearest points of an inserted one, the lowest number of the slice
/// comes next. Cost: O(n log n).
Array<u32> insertion_order(const growing::DistinctPoints& points, const growing::Neighbourhoods& neighbourhoods,
                           int axis, double slice, InPlane in_plane, Execution& execution);

}  // namespace scanmill::clustering
