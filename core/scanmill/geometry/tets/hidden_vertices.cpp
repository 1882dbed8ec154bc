// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/tets/hidden_vertices.hpp"

#include <algorithm>

namespace scanmill {

Array<u32> hidden_vertices(const TetMesh& tets) {
    Array<u8> in_cell(tets.positions.size());
    std::ranges::fill(in_cell, u8(0));
    for (const Tetrahedron& cell : tets.cells)
        for (u32 vertex : cell) in_cell[vertex] = 1;
    Array<u32> hidden;
    for (u32 vertex = 0; vertex < in_cell.size(); ++vertex)
        if (!in_cell[vertex]) hidden.push_back(vertex);
    return hidden;
}

}  // namespace scanmill
