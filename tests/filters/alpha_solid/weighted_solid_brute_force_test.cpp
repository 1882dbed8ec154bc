// SPDX-License-Identifier: GPL-3.0-or-later
// The alpha-solid of weighted points against its definition, in exact arithmetic.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "alpha_solid/widest_path_sweep.hpp"
#include "filters/alpha_solid/orthogonal_spheres.hpp"
#include "filters/alpha_solid/weighted_cases.hpp"
#include "scanmill/geometry/tets/solid_boundary.hpp"

namespace scanmill::alpha {
namespace {

using namespace test;

/// The definition, in exact arithmetic: whether the facet is a wall at squared radius `value`.
bool is_weighted_wall(const TetMesh& tets, u32 cell, int corner, double value) {
    const double largest = std::ranges::max(tets.weights);
    const auto at = [&](u32 vertex) { return WeightedPoint{&tets.positions[vertex], tets.weights[vertex]}; };
    const auto of_cell = [&](u32 c) {
        const auto& [i, j, k, l] = tets.cells[c];
        return Number(orthogonal_sphere({at(i), at(j), at(k), at(l)}).squared + Number(largest));
    };
    const Tetrahedron& own = tets.cells[cell];
    const auto& [i, j, k] = outward_facet[corner];
    const Ball facet = orthogonal_sphere({at(own[i]), at(own[j]), at(own[k])});
    bool attached = power(facet, at(own[corner])) < 0;
    Number least = of_cell(cell);
    if (const u32 across = tets.neighbours[cell][corner]; across != TetMesh::outside_hull) {
        for (u32 vertex : tets.cells[across])
            if (std::ranges::find(own, vertex) == own.end()) attached |= power(facet, at(vertex)) < 0;
        least = std::min(least, of_cell(across));
    }
    return (attached ? least : Number(facet.squared + Number(largest))) <= Number(value);
}

Array<u8> brute_force_inside(const TetMesh& tets, double value) {
    Array<u8> inside(tets.cells.size(), u8(1));
    std::deque<u32> open;
    const auto enter = [&](u32 cell) {
        inside[cell] = 0;
        open.push_back(cell);
    };
    for (u32 c = 0; c < inside.size(); ++c)
        for (int i = 0; i < 4; ++i)
            if (tets.neighbours[c][i] == TetMesh::outside_hull && inside[c] && !is_weighted_wall(tets, c, i, value))
                enter(c);
    for (; !open.empty(); open.pop_front())
        for (int i = 0; i < 4; ++i)
            if (const u32 across = tets.neighbours[open.front()][i];
                across != TetMesh::outside_hull && inside[across] && !is_weighted_wall(tets, open.front(), i, value))
                enter(across);
    return inside;
}

TEST(AlphaSolidWeights, Solid_IsTheBruteForceFloodFill) {
    const std::vector<TetMesh> all{weighted(with_random_weights(random_cube(60, 1), 0.05, 1), weighted_by("w")).tets,
                                   weighted(random_cube(60, 2)).tets,
                                   weighted(fibonacci_sphere(70, 1e-2), weighted_by("spacing", 0.5)).tets};
    int compared = 0;
    for (const TetMesh& tets : all) {
        Context context;
        const SweepResult sweep =
            sweep_from_outside(sweep_cells(tets, context), tets.positions.size(), {.value = 0, .coverage = 1}, context);
        for (double quantile : {0.05, 0.1, 0.2, 0.3, 0.5}) {
            std::size_t i = static_cast<std::size_t>(quantile * static_cast<double>(sweep.values.size()));
            while (i + 1 < sweep.values.size() && sweep.values[i + 1] > sweep.values[i] * (1 - 1e-6)) ++i;
            if (i + 1 == sweep.values.size()) continue;
            ++compared;
            const double alpha = std::sqrt(std::sqrt(sweep.values[i] * sweep.values[i + 1]));
            const AlphaSolidResult result = solid_of(tets, at_alpha(alpha));
            const Array<u8> expected = brute_force_inside(tets, alpha * alpha);
            EXPECT_TRUE(std::ranges::equal(result.tets.inside, expected)) << quantile;
        }
    }
    EXPECT_GE(compared, 9);
}

}  // namespace
}  // namespace scanmill::alpha
