// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// CGAL's Delaunay and regular triangulations as plain arrays, in whatever order CGAL made them.

#include <array>
#include <span>

#include "scanmill/data/tets.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct RawTriangulation {
    /// 3, or less when the points span no volume; then there are no cells.
    int dimension = 0;
    /// Input rows that lie exactly on an earlier row.
    Array<u32> duplicates;
    /// Corners are input rows, of several rows at one place the first; positively oriented, corners in canonical order.
    Array<Tetrahedron> cells;
    /// As TetMesh::neighbours.
    Array<std::array<u32, 4>> neighbours;
};

/// Pre: finite positions, at most 2^32 - 2. Throws Cancelled when asked to stop, between insertions.
RawTriangulation triangulate(std::span<const Vec3> positions, Context& context);

/// The regular triangulation of the rows that are no duplicates, on one thread. Which rows are hidden and what the
/// cells are depends on places and weights alone: ties are broken as without weights. Equal weights give
/// triangulate()'s. Pre: a weight per row, finite; `duplicates` as RawTriangulation has them.
RawTriangulation triangulate_weighted(std::span<const Vec3> positions, std::span<const double> weights,
                                      Array<u32> duplicates, Context& context);

}  // namespace scanmill
