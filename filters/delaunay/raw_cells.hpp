// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A triangulation of CGAL's as plain arrays: the same for every kind of it.

#include <vector>

#include "delaunay/canonical_cells.hpp"
#include "delaunay/triangulate.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"

namespace scanmill {

/// The finite cells in container order, and where every `chunk`-th of them is.
template <class Triangulation>
struct NumberedCells {
    static constexpr std::size_t chunk = 1 << 13;

    std::size_t count = 0;
    std::vector<typename Triangulation::Cell_handle> chunks;
};

/// Numbers the finite cells; infinite cells get TetMesh::outside_hull.
template <class Triangulation>
NumberedCells<Triangulation> number_cells(Triangulation& triangulation) {
    NumberedCells<Triangulation> cells;
    const typename Triangulation::Vertex_handle infinite = triangulation.infinite_vertex();
    auto& container = triangulation.tds().cells();
    for (auto cell = container.begin(); cell != container.end(); ++cell) {
        if (cell->has_vertex(infinite)) {
            cell->info().number = TetMesh::outside_hull;
            continue;
        }
        if (cells.count % cells.chunk == 0) cells.chunks.push_back(cell);
        cell->info().number = static_cast<u32>(cells.count++);
    }
    return cells;
}

/// What fill_cells() needs of a cell lies all over memory; asked for in time, it comes while others are worked on.
template <class Cell>
void fetch_round(Cell& cell) {
    for (int corner = 0; corner < 4; ++corner) {
        __builtin_prefetch(&cell.vertex(corner)->info());
        __builtin_prefetch(&cell.neighbor(corner)->info());
    }
}

/// Fills raw.cells and raw.neighbours. Pre: of dimension 3; vertices and cells as in cell_containers.hpp.
template <class Triangulation>
void fill_cells(Triangulation& triangulation, std::size_t points, unsigned threads, RawTriangulation& raw) {
    const NumberedCells<Triangulation> cells = number_cells(triangulation);
    if (cells.count >= TetMesh::outside_hull)
        throw Error("the tetrahedralisation of {} points has {} cells; at most {} can be numbered", points, cells.count,
                    TetMesh::outside_hull - 1)
            .hint("voxel-thin keeps fewer points");
    constexpr std::size_t few = 16;
    raw.cells.resize(cells.count);
    raw.neighbours.resize(cells.count);
    const auto last = triangulation.tds().cells().end();
    for_each_chunk(threads, cells.count, cells.chunk, [&](std::size_t begin, std::size_t end) {
        auto at = cells.chunks[begin / cells.chunk], soon = at;
        for (std::size_t ahead = 0; ahead < few && soon != last; ++ahead, ++soon) fetch_round(*soon);
        for (std::size_t c = begin; c < end; ++at) {
            if (soon != last) fetch_round(*soon++);
            if (at->info().number == TetMesh::outside_hull) continue;
            Tetrahedron cell;
            for (int corner = 0; corner < 4; ++corner) cell[corner] = at->vertex(corner)->info().row;
            const std::array<int, 4> corners = canonical_corners(cell);
            for (int i = 0; i < 4; ++i) {
                raw.cells[c][i] = cell[corners[i]];
                raw.neighbours[c][i] = at->neighbor(corners[i])->info().number;
            }
            ++c;
        }
    });
}

}  // namespace scanmill
