// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/facet_values.hpp"

#include <algorithm>

#include "alpha_solid/weighted_spheres.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"

namespace scanmill::alpha {

namespace {

/// `spheres(cell, facets)` gives a cell's CellSpheres; its part alone will do for facets that are not in the mask.
template <class Spheres>
Array<SweepCell> sweep_cells_with(const TetMesh& tets, const Spheres& spheres, Context& context) {
    constexpr std::size_t chunk = 1 << 13;
    const std::size_t count = tets.cells.size();
    Array<SweepCell> cells(count);
    // Where one of its two cells attaches a facet, that cell's part is the larger.
    const auto join = [&](std::size_t c, int corner, u32 across) {
        SweepCell& other = cells[across];
        const auto back = std::ranges::find(other.neighbours, static_cast<u32>(c)) - other.neighbours.begin();
        double &mine = cells[c].values[corner], &its = other.values[back];
        mine = its = std::max(mine, its);
    };
    const bool alone = context.threads() <= 1;
    for_each_chunk(context.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        const std::size_t first_known = alone ? 0 : begin;
        for (std::size_t c = begin; c < end; ++c) {
            const auto is_known = [&](int corner) {
                return tets.neighbours[c][corner] >= first_known && tets.neighbours[c][corner] < c;
            };
            unsigned unknown = 0;
            for (int corner = 0; corner < 4; ++corner) unknown |= unsigned(!is_known(corner)) << corner;
            cells[c] = {spheres(tets.cells[c], unknown).values, tets.cells[c], tets.neighbours[c]};
            for (int corner = 0; corner < 4; ++corner)
                if (is_known(corner)) join(c, corner, tets.neighbours[c][corner]);
        }
    });
    if (alone) return cells;
    // Two cells in different chunks, now that both are there.
    for_each_chunk(context.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t c = begin; c < end; ++c)
            for (int corner = 0; corner < 4; ++corner)
                if (const u32 across = tets.neighbours[c][corner]; across >= end && across != TetMesh::outside_hull)
                    join(c, corner, across);
    });
    return cells;
}

}  // namespace

Array<SweepCell> sweep_cells(const TetMesh& tets, Context& context) {
    const auto unweighted = [&](const Tetrahedron& cell, unsigned) {
        const auto& [i, j, k, l] = cell;
        return cell_spheres(tets.positions[i], tets.positions[j], tets.positions[k], tets.positions[l]);
    };
    if (tets.weights.empty()) return sweep_cells_with(tets, unweighted, context);
    if (tets.weights.size() != tets.positions.size())
        throw Error("needs a weight for each of {} vertices or none; there are {}", tets.positions.size(),
                    tets.weights.size())
            .hint("'delaunay: {weights: …}' gives each a weight");
    const auto [least, largest] = std::ranges::minmax(tets.weights);
    if (!(least < largest)) return sweep_cells_with(tets, unweighted, context);
    const auto weighted = [&tets, largest = largest](const Tetrahedron& cell, unsigned facets) {
        std::array<WeightedPoint, 4> corners;
        for (int i = 0; i < 4; ++i) corners[i] = {&tets.positions[cell[i]], tets.weights[cell[i]]};
        return weighted_cell_spheres(corners, largest, facets);
    };
    return sweep_cells_with(tets, weighted, context);
}

}  // namespace scanmill::alpha
