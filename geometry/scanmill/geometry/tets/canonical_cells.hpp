// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Puts cells into the canonical order of tets.hpp, so that equal triangulations have equal bytes; and numbers vertices
/// and cells anew along a space-filling curve.

#include <algorithm>
#include <array>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/tets.hpp"

namespace scanmill {

/// The even permutation of the corners that makes the cell lexicographically smallest, as indices into `cell`.
inline std::array<int, 4> canonical_corners(const Tetrahedron& cell) {
    constexpr std::array<std::array<int, 4>, 4> first{{{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 0, 1, 3}, {3, 0, 2, 1}}};
    const std::array<int, 4>& corners = first[std::ranges::min_element(cell) - cell.begin()];
    // Rotating the other three corners is an even permutation, too. The smallest of the three comes second.
    const u32 b = cell[corners[1]], c = cell[corners[2]], d = cell[corners[3]];
    if (c < b && c < d) return {corners[0], corners[2], corners[3], corners[1]};
    if (d < b && d < c) return {corners[0], corners[3], corners[1], corners[2]};
    return corners;
}

struct CanonicalCells {
    Array<Tetrahedron> cells;
    Array<std::array<u32, 4>> neighbours;
    Array<u32> number;  ///< by cell of the input, its number in the result
};

/// Sorts the cells and renumbers their neighbours. Pre: corners are below `vertices`, and in canonical order in each
/// cell; all cells are different; neighbours are as in TetMesh.
/// Cost: linear, except for sorting the few cells that begin with the same vertex; 24 bytes per cell beside the result.
CanonicalCells canonical_cells(Array<Tetrahedron> cells, Array<std::array<u32, 4>> neighbours, std::size_t vertices,
                               unsigned threads);

/// A tetrahedralisation whose vertices are numbered along a space-filling curve (see spatial_order.hpp) and whose cells
/// are in canonical order then. Cells and vertices with near numbers are near each other, so walks read near memory.
/// The numbers do not depend on the order of the given vertices, unless several lie in one of the curve's steps.
struct SpatialTets {
    TetMesh tets;  ///< without columns, weights and labels
    Array<u32> vertices;  ///< by vertex of `tets`, the given vertex
    Array<u32> cells;  ///< by given cell, its number in `tets`
};

/// Cost: linear; 24 bytes per cell beside the result.
SpatialTets in_spatial_order(const TetMesh& tets, Execution& execution);

}  // namespace scanmill
