// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The pairs of a mesh's triangles that intersect.

#include <array>
#include <limits>
#include <span>

#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

struct SelfIntersections {
    /// Number of all pairs.
    u64 count = 0;
    /// Rows of triangles, the smaller first; in ascending order.
    Array<std::array<u32, 2>> pairs;
};

/// Pairs of triangles that intersect as triangles_intersect() defines it, where vertices at one position count as one
/// vertex: a soup has the same pairs as the mesh that it draws. Only the first `most_pairs` pairs are returned.
///
/// Pre: finite coordinates; `tree` is over exactly these positions and triangles. Nothing depends on the number of
/// threads. Cost: O(F log F) plus one test for each pair of overlapping boxes; about 1 µs per triangle of a good mesh.
SelfIntersections self_intersections(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                     const TriangleTree& tree, Execution& execution,
                                     u64 most_pairs = std::numeric_limits<u64>::max());

}  // namespace scanmill
