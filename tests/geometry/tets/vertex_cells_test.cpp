// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/tets/vertex_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "scanmill/base/random.hpp"

namespace scanmill::test {
namespace {

/// Cells with random corners; VertexCells needs no geometry. Some vertices are in no cell.
TetMesh tets_of_random_corners(std::size_t vertices, std::size_t cells, u64 seed) {
    Random random(seed);
    Array<Tetrahedron> all(cells);
    for (Tetrahedron& cell : all) do {
            for (u32& corner : cell) corner = static_cast<u32>(random.index(vertices)) & ~u32(1);
        } while (cell[0] == cell[1] || cell[0] == cell[2] || cell[0] == cell[3] || cell[1] == cell[2] ||
                 cell[1] == cell[3] || cell[2] == cell[3]);
    TetMesh tets;
    tets.positions = Array<Vec3>(vertices, Vec3::Zero());
    tets.cells = std::move(all);
    return tets;
}

TEST(VertexCells, EqualASearchForAnyNumberOfThreads) {
    for (const std::size_t vertices : {std::size_t(9), std::size_t(500)}) {
        const TetMesh tets = tets_of_random_corners(vertices, 50'000, vertices);  // more than one chunk of work
        std::vector<std::vector<u32>> expected(vertices);
        for (u32 cell = 0; cell < tets.cells.size(); ++cell)
            for (const u32 vertex : tets.cells[cell]) expected[vertex].push_back(cell);
        for (const unsigned threads : {1u, 2u, 8u}) {
            const VertexCells cells_at(tets, threads);
            for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
                std::vector<u32> found(cells_at[vertex].begin(), cells_at[vertex].end());
                std::ranges::sort(found);
                EXPECT_EQ(found, expected[vertex]) << vertex << ", " << threads << " threads";
            }
        }
        EXPECT_TRUE(VertexCells(tets, 1)[1].empty()) << "an odd vertex is in no cell";
    }
}

TEST(VertexCells, WithoutCells_AreEmpty) {
    TetMesh tets;
    tets.positions = Array<Vec3>(3, Vec3::Zero());
    const VertexCells cells_at(tets, 2);
    for (std::size_t vertex = 0; vertex < 3; ++vertex) EXPECT_TRUE(cells_at[vertex].empty());
}

}  // namespace
}  // namespace scanmill::test
