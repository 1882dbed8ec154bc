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
    /// Corners are input rows; of several rows at one position, the first. Cells are positively oriented, with their
    /// corners in canonical order.
    Array<Tetrahedron> cells;
    /// As TetMesh::neighbours.
    Array<std::array<u32, 4>> neighbours;
};

/// Inserts the points in a biased randomised order along Hilbert curves, in rounds of doubling size. From 10,000 points
/// on, all threads insert points. An insertion locks the boxes of a spatial grid that it touches. If another thread has
/// locked one of them, the insertion is retried later. Pre: finite positions, at most 2^32 - 2. Throws Cancelled
/// between insertions when cancelled.
RawTriangulation triangulate(std::span<const Vec3> positions, Context& context);

/// The regular triangulation of the rows that are not duplicates, on one thread. The hidden rows and the cells depend
/// on positions and weights alone, because ties are broken as in triangulate(). With equal weights the result is that
/// of triangulate(). Pre: one finite weight per row; `duplicates` as in RawTriangulation.
RawTriangulation triangulate_weighted(std::span<const Vec3> positions, std::span<const double> weights,
                                      Array<u32> duplicates, Context& context);

}  // namespace scanmill
