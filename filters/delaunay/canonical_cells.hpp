// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Puts cells into the canonical order of tets.hpp, so that equal triangulations are equal bytes.

#include <algorithm>
#include <array>

#include "scanmill/data/tets.hpp"

namespace scanmill {

/// The corners of `cell` in canonical order, as indices into it: the even permutation that makes it lexicographically
/// smallest.
inline std::array<int, 4> canonical_corners(const Tetrahedron& cell) {
    constexpr std::array<std::array<int, 4>, 4> first{{{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 0, 1, 3}, {3, 0, 2, 1}}};
    const std::array<int, 4>& corners = first[std::ranges::min_element(cell) - cell.begin()];
    // Rotating the other three is even as well; the smallest of them comes second.
    const u32 b = cell[corners[1]], c = cell[corners[2]], d = cell[corners[3]];
    if (c < b && c < d) return {corners[0], corners[2], corners[3], corners[1]};
    if (d < b && d < c) return {corners[0], corners[3], corners[1], corners[2]};
    return corners;
}

struct CanonicalCells {
    Array<Tetrahedron> cells;
    Array<std::array<u32, 4>> neighbours;
};

/// Pre: corners < vertices, each cell's in canonical order, cells all different, neighbours as in TetMesh.
/// Cost: linear but for sorting the few cells that begin with the same vertex; 24 more bytes per cell while it works.
CanonicalCells canonical_cells(Array<Tetrahedron> cells, Array<std::array<u32, 4>> neighbours, std::size_t vertices,
                               unsigned threads);

}  // namespace scanmill
