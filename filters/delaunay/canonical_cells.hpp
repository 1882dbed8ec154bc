// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Puts cells into the canonical order of tets.hpp, so that equal triangulations are equal bytes.

#include <array>

#include "scanmill/data/tets.hpp"

namespace scanmill {

struct CanonicalCells {
    Array<Tetrahedron> cells;
    Array<std::array<u32, 4>> neighbours;
};

/// Pre: corners < vertices, cells positively oriented and all different, neighbours as in TetMesh.
/// Cost: linear but for sorting the few cells that begin with the same vertex; 36 more bytes per cell while it works.
CanonicalCells canonical_cells(Array<Tetrahedron> cells, Array<std::array<u32, 4>> neighbours, std::size_t vertices,
                               unsigned threads);

}  // namespace scanmill
