// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// CGAL's Delaunay and regular triangulations as plain arrays, with cells in the order of CGAL's containers.

#include <array>
#include <span>

#include "scanmill/data/tets.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct RawTriangulation {
    /// 3, or less when the points span no volume; then there are no cells.
    int dimension = 0;
    /// Input rows whose position is exactly that of an earlier row.
    Array<u32> duplicates;
    /// Corners are input rows, of several rows at one position the first; positively oriented, corners in canonical
    /// order.
    Array<Tetrahedron> cells;
    /// As TetMesh::neighbours.
    Array<std::array<u32, 4>> neighbours;
};

/// Points are inserted in a biased randomised order along Hilbert curves, in rounds of doubling size; from 10,000
/// points on, by all threads. Each thread locks the boxes of a grid over space that its insertion touches, and retries
/// later when another thread has locked one of them. Pre: finite positions, at most 2^32 - 2. Throws Cancelled between
/// insertions when cancelled.
RawTriangulation triangulate(std::span<const Vec3> positions, Context& context);

/// The regular triangulation of the rows that are not duplicates, on one thread. Which rows are hidden and what the
/// cells are depends on positions and weights alone: ties are broken as without weights. Equal weights give the result
/// of triangulate(). Pre: a weight per row, finite; `duplicates` as in RawTriangulation.
RawTriangulation triangulate_weighted(std::span<const Vec3> positions, std::span<const double> weights,
                                      Array<u32> duplicates, Context& context);

}  // namespace scanmill
