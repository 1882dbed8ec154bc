// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Lists the changes between two closed meshes that have most triangles in common: where the new surface differs from
/// the old one, and the volume that each change adds and removes.

#include <span>
#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::updating {

/// The triangles that only one of the two meshes has, with the positions of all vertices of that mesh.
struct ChangedTriangles {
    std::span<const Vec3> positions;
    std::span<const Triangle> triangles;
};

/// A vertex of the new mesh that is not a vertex of the old one.
inline constexpr u32 no_common_vertex = ~u32(0);

struct Change {
    double area = 0;  ///< total area of the new triangles
    double volume_added = 0;  ///< inside the new solid and outside the old one
    double volume_removed = 0;  ///< inside the old solid and outside the new one
    std::vector<u32> old_triangles, new_triangles;  ///< positions in the lists of changed triangles, ascending
};

/// The connected components of the changed triangles. Triangles with a common vertex are connected; an old and a new
/// triangle have a common vertex if `common` relates a vertex of one to a vertex of the other. `common` contains, for
/// each vertex of `after`, the vertex of `before` at the same position, or no_common_vertex.
///
/// The old triangles, reversed, and the new ones enclose the difference of the two solids, so the unchanged triangles
/// are not needed. Their signed volume is volume_added - volume_removed. The split into both comes from a grid of
/// parallel lines through the change: along a line, the difference of the two insides changes by one at each triangle.
/// The lines are tilted by 21° from the axis along which the change is thinnest. There are 64 lines per triangle, but
/// at least 64 × 64 and at most 512 × 512.
///
/// Each change is measured by itself, even if it contains another one. Where a solid overlaps itself, volume counts as
/// often as it is covered.
///
/// Pre:  the old triangles, reversed, and the new ones have each edge as often in one direction as in the other, which
///       holds for the difference of two closed meshes. `common` has an entry for each vertex of `after`. All
///       coordinates are finite.
/// Post: ordered by lowest old triangle; changes without old triangles are last, ordered by lowest new triangle.
///       volume_added - volume_removed is exact to rounding, so both are exact in a change that only adds or only
///       removes. Volumes that rounding explains (triangles in one plane) are 0. In a change that does both, added and
///       removed have the same error, as a share of their sum (measured in 60 to 300 random positions):
///
///         lines       shapes                                                mean    worst
///         64 × 64     waves, blocks                                         1e-4    2e-2
///         64 × 64     slices as thin as a thousandth of the change's size   2e-3    6e-2
///         512 × 512   waves, blocks                                         3e-7    2e-5
///         512 × 512   slices as thin as a thousandth of the change's size   2e-5    3e-4
///
///       The result does not depend on the number of threads.
/// Cost: O(k log k) for k triangles, and the lines: below 1 ms for 64 × 64, about 20 ms for 512 × 512. Nothing depends
///       on the unchanged part of the meshes.
std::vector<Change> changes(const ChangedTriangles& before, const ChangedTriangles& after, std::span<const u32> common,
                            Context& context);

}  // namespace scanmill::updating
