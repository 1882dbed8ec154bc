// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/facet_values.hpp"

#include <algorithm>

#include "scanmill/filter/parallel.hpp"

namespace scanmill::alpha {

namespace {

constexpr std::size_t chunk = 1 << 14;

int corner_across(const std::array<u32, 4>& neighbours, u32 cell) {
    return static_cast<int>(std::ranges::find(neighbours, cell) - neighbours.begin());
}

}  // namespace

FacetValues facet_values(const TetMesh& tets, Context& context) {
    const std::size_t cells = tets.cells.size();
    Array<double> cell_values(cells);
    Array<u8> attached(cells);
    for_each_chunk(context.threads(), cells, chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t c = begin; c < end; ++c) {
            const auto& [i, j, k, l] = tets.cells[c];
            const Circumsphere sphere =
                circumsphere(tets.positions[i], tets.positions[j], tets.positions[k], tets.positions[l]);
            cell_values[c] = sphere.squared_radius;
            attached[c] = sphere.attached;
        }
    });

    FacetValues values(cells);
    for_each_chunk(context.threads(), cells, chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (u32 c = static_cast<u32>(begin); c < end; ++c)
            for (int corner = 0; corner < 4; ++corner) {
                // The facet's first cell computes it for both.
                const u32 across = tets.neighbours[c][corner];
                if (across < c) continue;
                const auto& [i, j, k] = outward_facet[corner];
                const Tetrahedron& cell = tets.cells[c];
                double value = squared_circumradius(tets.positions[cell[i]], tets.positions[cell[j]],
                                                    tets.positions[cell[k]]);
                bool is_attached = attached[c] >> corner & 1;
                double smaller_cell = cell_values[c];
                if (across != TetMesh::outside_hull) {
                    const int back = corner_across(tets.neighbours[across], c);
                    is_attached = is_attached || (attached[across] >> back & 1);
                    if (is_attached) value = std::max(value, std::min(smaller_cell, cell_values[across]));
                    values[across][back] = value;
                } else if (is_attached) {
                    value = std::max(value, smaller_cell);
                }
                values[c][corner] = value;
            }
    });
    return values;
}

}  // namespace scanmill::alpha
