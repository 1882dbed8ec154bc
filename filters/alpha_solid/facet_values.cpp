// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/facet_values.hpp"

#include <algorithm>

#include "scanmill/filter/parallel.hpp"

namespace scanmill::alpha {

Array<SweepCell> sweep_cells(const TetMesh& tets, Context& context) {
    constexpr std::size_t chunk = 1 << 14;
    const std::size_t count = tets.cells.size();
    Array<SweepCell> cells(count);
    for_each_chunk(context.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t c = begin; c < end; ++c) {
            const auto& [i, j, k, l] = tets.cells[c];
            cells[c] = {cell_spheres(tets.positions[i], tets.positions[j], tets.positions[k], tets.positions[l]).values,
                        tets.cells[c], tets.neighbours[c]};
        }
    });

    // Where one of its two cells attaches a facet, that cell's part is the larger.
    for_each_chunk(context.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t c = begin; c < end; ++c)
            for (int corner = 0; corner < 4; ++corner) {
                const u32 across = cells[c].neighbours[corner];
                if (across == TetMesh::outside_hull || across < c) continue;
                SweepCell& other = cells[across];
                const auto back = std::ranges::find(other.neighbours, static_cast<u32>(c)) - other.neighbours.begin();
                double &mine = cells[c].values[corner], &its = other.values[back];
                mine = its = std::max(mine, its);
            }
    });
    return cells;
}

}  // namespace scanmill::alpha
