// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `points`: a scan as an unordered list of positions with per-point columns.

#include "scanmill/data/bounds.hpp"
#include "scanmill/data/columns.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

struct PointCloud {
    Frame frame;
    /// #points, relative to frame.origin. May contain NaN or infinity as read: filters refuse those by
/// require_finite().
    Buffer<Vec3> positions;
    /// Every column has #points rows.
    ColumnTable columns;

    std::size_t size() const { return positions.size(); }
};

/// The points at `rows` with all their columns, in the order of `rows`.
PointCloud gather(const PointCloud& cloud, std::span<const u32> rows);

/// Throws Error if a coordinate is NaN or infinite, with the number of such points and the first of them. `what` names
/// the elements in the message: "points", "vertices".
void require_finite(std::span<const Vec3> positions, std::string_view what = "points");

/// The rows of the positions whose three coordinates are finite, ascending.
Array<u32> finite_rows(std::span<const Vec3> positions);

template <class Geometry>
struct Cleaned {
    Geometry result;
    std::size_t points = 0;     ///< number of points or vertices removed
    std::size_t triangles = 0;  ///< number of triangles removed
};

/// The points whose three coordinates are finite, in order, with all columns.
Cleaned<PointCloud> without_invalid_points(const PointCloud& cloud);

/// Adds `shift` to every position.
Buffer<Vec3> translated(const Buffer<Vec3>& positions, const Vec3& shift);

}  // namespace scanmill
