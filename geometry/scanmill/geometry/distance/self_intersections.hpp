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
    /// Rows of the two triangles, the smaller first; pairs ascend. Contains only the first `most_pairs` pairs.
    Array<std::array<u32, 2>> pairs;
};

/// Finds the pairs of triangles that intersect as triangles_intersect() defines it. Vertices at one position count as
/// one vertex, so a triangle soup has the same pairs as the connected mesh with the same triangles.
///
/// Pre: finite coordinates; `tree` contains exactly these positions and triangles. The result does not depend on the
/// number of threads. Cost: O(F log F) plus one test for each pair of overlapping boxes; about 1 µs per triangle of a
/// good mesh.
SelfIntersections self_intersections(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                     const TriangleTree& tree, Execution& execution,
                                     u64 most_pairs = std::numeric_limits<u64>::max());

}  // namespace scanmill
