// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/tets/vertex_cells.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

#include "scanmill/base/parallel.hpp"

namespace scanmill {

VertexCells::VertexCells(const TetMesh& tets, unsigned threads)
    : ends_(tets.positions.size()),
      cells_(4 * tets.cells.size()) {
    constexpr std::size_t chunk = 1 << 14;
    std::ranges::fill(ends_, u64(0));
    const auto claim = [&, alone = threads <= 1](u32 vertex) {
        return alone ? ends_[vertex]++ : std::atomic_ref(ends_[vertex]).fetch_add(1, std::memory_order_relaxed);
    };
    const auto for_each_corner = [&](auto&& visit) {
        for_each_chunk(threads, tets.cells.size(), chunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t cell = begin; cell < end; ++cell)
                for (const u32 vertex : tets.cells[cell]) visit(cell, vertex);
        });
    };
    for_each_corner([&](std::size_t, u32 vertex) { claim(vertex); });
    u64 start = 0;
    for (u64& entry : ends_) start += std::exchange(entry, start);
    // Every claim() increases a start, so at the end each start has become the end of its list.
    for_each_corner([&](std::size_t cell, u32 vertex) { cells_[claim(vertex)] = static_cast<u32>(cell); });
}

}  // namespace scanmill
