// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `points`: a scan as an unordered list of positions with per-point columns.

#include "scanmill/data/bounds.hpp"
#include "scanmill/data/columns.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

struct PointCloud {
    Frame frame;
    /// #points, relative to frame.origin. May hold NaN or infinity as read: filters refuse those, see require_finite().
    Buffer<Vec3> positions;
    /// Every column has #points rows.
    ColumnTable columns;

    std::size_t size() const { return positions.size(); }
};

/// The named points with all their columns, in the order of `rows`.
PointCloud gather(const PointCloud& cloud, std::span<const u32> rows);

/// Throws Error when a coordinate is NaN or infinite: how many points, which is the first.
/// `what` names the elements in the message: "points", "vertices".
void require_finite(std::span<const Vec3> positions, std::string_view what = "points");

/// Adds `shift` to every position.
Buffer<Vec3> translated(const Buffer<Vec3>& positions, const Vec3& shift);

}  // namespace scanmill
