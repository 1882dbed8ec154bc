// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A triangulation of CGAL's as plain arrays: the same for every kind of it.

#include <vector>

#include "delaunay/canonical_cells.hpp"
#include "delaunay/triangulate.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/filter/parallel.hpp"

namespace scanmill {

/// Numbers the finite cells in container order; infinite cells get TetMesh::outside_hull.
template <class Triangulation>
std::vector<typename Triangulation::Cell_handle> number_cells(Triangulation& triangulation) {
    std::vector<typename Triangulation::Cell_handle> cells;
    cells.reserve(triangulation.tds().number_of_cells());
    const typename Triangulation::Vertex_handle infinite = triangulation.infinite_vertex();
    auto& container = triangulation.tds().cells();
    for (auto cell = container.begin(); cell != container.end(); ++cell) {
        if (cell->has_vertex(infinite)) {
            cell->info() = TetMesh::outside_hull;
            continue;
        }
        cell->info() = static_cast<u32>(cells.size());
        cells.push_back(cell);
    }
    return cells;
}

/// Fills raw.cells and raw.neighbours. Pre: of dimension 3; a vertex's info has its `row`, a cell's info is a u32.
template <class Triangulation>
void fill_cells(Triangulation& triangulation, std::size_t points, unsigned threads, RawTriangulation& raw) {
    const auto cells = number_cells(triangulation);
    if (cells.size() >= TetMesh::outside_hull)
        throw Error("the tetrahedralisation of {} points has {} cells; at most {} can be numbered", points,
                    cells.size(), TetMesh::outside_hull - 1)
            .hint("voxel-thin keeps fewer points");
    raw.cells.resize(cells.size());
    raw.neighbours.resize(cells.size());
    for_each_chunk(threads, cells.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            Tetrahedron cell;
            for (int corner = 0; corner < 4; ++corner) cell[corner] = cells[c]->vertex(corner)->info().row;
            const std::array<int, 4> corners = canonical_corners(cell);
            for (int i = 0; i < 4; ++i) {
                raw.cells[c][i] = cell[corners[i]];
                raw.neighbours[c][i] = cells[c]->neighbor(corners[i])->info();
            }
        }
    });
}

}  // namespace scanmill
