// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The distances from many points, or from the vertices of a mesh, to a surface.

#include <span>

#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

/// The distance below which positions near `largest_coordinate` cannot be distinguished.
constexpr double position_rounding(double largest_coordinate) { return 0x1p-46 * largest_coordinate; }

struct NearestDistances {
    /// Distances in the order of the points; 0 for a distance not above `rounding`.
    Array<double> distances;
    /// Rows of the nearest triangles; of equally near triangles, the smallest row.
    Array<u32> triangles;
    /// The same triangles as NearestTriangle::slot in the tree.
    Array<u32> slots;
};

/// Computes the distance of every point to the surface. Visits the points along a space-filling curve and starts each
/// search at the previous result. Pre: finite points. Bytes do not depend on the number of threads.
NearestDistances nearest_distances(std::span<const Vec3> points, const TriangleTree& surface, double rounding,
                                   Execution& execution);

/// The same for the vertices of a mesh; results are indexed by vertex. A vertex in no triangle has distance 0 and
/// NearestTriangle::none.
NearestDistances nearest_of_vertices(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                     const TriangleTree& surface, double rounding, Execution& execution);

}  // namespace scanmill
