// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `points`: a scan as an unordered list of positions with per-point columns.

#include <limits>

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

/// Componentwise bounds of the finite positions; empty() when there are none.
struct BoundingBox {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = Vec3::Constant(-std::numeric_limits<double>::infinity());

    bool empty() const { return !(low.array() <= high.array()).all(); }
    /// Length of the diagonal; 0 when empty.
    double diagonal() const { return empty() ? 0 : (high - low).stableNorm(); }
};
BoundingBox bounding_box(std::span<const Vec3> positions);

/// A good origin for world positions inside `box`: along every axis whose coordinates are large against the diagonal, a
/// coarse power-of-two multiple near the middle, else 0. Chosen so that p - origin, and origin + (p - origin), are
/// exact in double for every p in the box. Zero for a box without points or with an infinite bound.
Vec3 distant_origin(const BoundingBox& box);

/// Adds `shift` to every position.
Buffer<Vec3> translated(const Buffer<Vec3>& positions, const Vec3& shift);

}  // namespace scanmill
