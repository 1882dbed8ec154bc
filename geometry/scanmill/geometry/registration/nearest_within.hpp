// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds the nearest of some thousand points within a fixed reach, many times. Each cell of a grid lists all points
/// that can be the nearest to a position in the cell; a query looks at one list.

#include <span>

#include "scanmill/data/array.hpp"
#include "scanmill/data/bounds.hpp"

namespace scanmill {

class NearestWithin {
public:
    static constexpr u32 none = ~u32(0);

    /// Copies the points. Pre: finite; reach > 0. Cost: about 5 us and 1 KB per point where points are half of `reach`
    /// apart.
    NearestWithin(std::span<const Vec3> points, double reach);

    /// The index of the point nearest to `position`, or `none` if none is closer than `distance`. Ties: the lower
    /// index. Pre: distance <= reach. Cost: about 20 ns. Safe from several threads.
    u32 nearest(const Vec3& position, double distance) const;

private:
    Array<Vec3> points_;
    BoundingBox box_;  ///< of the cells
    double edge_;
    std::size_t cells_[3];
    Array<u32> begin_, lists_;
};

}  // namespace scanmill
