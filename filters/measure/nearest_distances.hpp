// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The distances from many points to one surface.

#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::measuring {

struct NearestDistances {
    /// In the points' order; those not above `rounding` are 0.
    Array<double> distances;
    /// Rows of the nearest triangles.
    Array<u32> triangles;
};

/// Asked along a space-filling curve, so that the last answer helps the next. Pre: finite points.
NearestDistances nearest_distances(std::span<const Vec3> points, const TriangleTree& surface, double rounding,
                                   Context& context);

}  // namespace scanmill::measuring
