// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds the points that a closed surface encloses.

#include <span>

#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

/// Returns 1 for every point that the surface encloses, else 0. The surface encloses a point if its winding number
/// around the point is not 0. So a surface that is inside out encloses the same points, and an inner surface with the
/// opposite orientation bounds a cavity.
///
/// Pre: finite points. Every edge of the surface has as many half-edges in one direction as in the other, as
/// topology().closed implies. The surface may intersect or touch itself and have degenerate triangles. `tree` contains
/// exactly these positions and triangles.
/// Post: exact for any triangles. Points on the surface get either value. Points outside its bounding box get 0. Bytes
/// do not depend on the number of threads.
/// Cost: per point, less than a search for the nearest triangle: 0.4 to 0.8 µs on meshes of 5,000 to 800,000 triangles.
/// Method: the signed crossings of the ray to the nearest side of the bounding box are summed. Exact predicates decide
/// the crossings, with a symbolic perturbation where the ray meets edges and corners.
Array<u8> enclosed(std::span<const Vec3> points, std::span<const Vec3> positions, std::span<const Triangle> triangles,
                   const TriangleTree& tree, Execution& execution);

}  // namespace scanmill
