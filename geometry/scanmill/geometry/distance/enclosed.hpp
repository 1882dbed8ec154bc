// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Which points a closed surface encloses.

#include <span>

#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

/// 1 for every point that the surface encloses, else 0: points around which it winds, outward or inward, so that a
/// surface that is inside out encloses the same points, and an inner surface with the opposite orientation bounds a
/// cavity.
///
/// Pre: finite points; every edge of the surface has as many half-edges in one direction as in the other, as
/// topology().closed implies. It may intersect or touch itself and have degenerate triangles. `tree` is of it.
/// Post: exact, whatever the triangles are like; either value for points on the surface, others get 0 outside its
/// bounding box. Bytes do not depend on the number of threads.
/// Cost: per point, less than a search for the nearest triangle: 0.4 to 0.8 µs on meshes of 5,000 to 800,000 triangles.
/// Method: signed crossings of the ray to the nearest side of the bounding box, by exact predicates, with a symbolic
/// perturbation where it meets edges and corners.
Array<u8> enclosed(std::span<const Vec3> points, std::span<const Vec3> positions, std::span<const Triangle> triangles,
                   const TriangleTree& tree, Execution& execution);

}  // namespace scanmill
