// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The cells at every vertex, stored one after another.

#include <span>

#include "scanmill/data/array.hpp"
#include "scanmill/data/tets.hpp"

namespace scanmill {

class VertexCells {
public:
    /// Cost: linear; 16 bytes per cell and 8 per vertex.
    VertexCells(const TetMesh& tets, unsigned threads);

    /// In unspecified order; empty for a hidden vertex.
    std::span<const u32> operator[](std::size_t vertex) const {
        const std::size_t first = vertex == 0 ? 0 : ends_[vertex - 1];
        return std::span(cells_).subspan(first, ends_[vertex] - first);
    }

private:
    Array<u64> ends_;
    Array<u32> cells_;
};

}  // namespace scanmill
