// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay/triangulate.hpp"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Spatial_sort_traits_adapter_3.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include <algorithm>

#include "delaunay/canonical_cells.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/filter/parallel.hpp"

namespace scanmill {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<u32, Kernel>;
using CellBase =
    CGAL::Triangulation_cell_base_with_info_3<u32, Kernel, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
using Triangulation =
    CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;
using PointRow = std::pair<Kernel::Point_3, u32>;

constexpr std::size_t chunk = 1 << 14;

/// The points in a biased randomised order along Hilbert curves: what makes incremental insertion fast.
std::vector<PointRow> insertion_order(std::span<const Vec3> positions, unsigned threads) {
    std::vector<PointRow> points(positions.size());
    for_each_chunk(threads, positions.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const Vec3& p = positions[row];
            points[row] = {Kernel::Point_3(p.x(), p.y(), p.z()), static_cast<u32>(row)};
        }
    });
    using Traits = CGAL::Spatial_sort_traits_adapter_3<Kernel, CGAL::First_of_pair_property_map<PointRow>>;
    const auto sort = [&]<class Concurrency>(Concurrency) {
        CGAL::spatial_sort<Concurrency>(points.begin(), points.end(), Traits());
    };
    if (threads > 1)
        within_thread_budget(threads, [&] { sort(CGAL::Parallel_tag()); });
    else
        sort(CGAL::Sequential_tag());
    return points;
}

/// Inserts all points; a vertex's info becomes the first input row at its place.
Array<u32> insert_all(Triangulation& triangulation, const std::vector<PointRow>& points, Context& context) {
    Array<u32> duplicates;
    Triangulation::Vertex_handle last;
    std::size_t vertices = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i % 4096 == 0) {
            context.check_cancelled();
            context.progress(0.05 + 0.75 * static_cast<double>(i) / static_cast<double>(points.size()));
        }
        const auto& [point, row] = points[i];
        last = triangulation.insert(point, last);
        if (triangulation.number_of_vertices() > vertices) {
            ++vertices;
            last->info() = row;
        } else {
            duplicates.push_back(std::max(last->info(), row));
            last->info() = std::min(last->info(), row);
        }
    }
    std::ranges::sort(duplicates);
    return duplicates;
}

/// Numbers the finite cells in container order; infinite cells get TetMesh::outside_hull.
std::vector<Triangulation::Cell_handle> number_cells(Triangulation& triangulation) {
    std::vector<Triangulation::Cell_handle> cells;
    cells.reserve(triangulation.tds().number_of_cells());
    const Triangulation::Vertex_handle infinite = triangulation.infinite_vertex();
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

}  // namespace

RawTriangulation triangulate(std::span<const Vec3> positions, Context& context) {
    RawTriangulation raw;
    Triangulation triangulation;
    {
        const std::vector<PointRow> points = insertion_order(positions, context.threads());
        raw.duplicates = insert_all(triangulation, points, context);
    }
    raw.dimension = triangulation.dimension();
    if (raw.dimension < 3) return raw;

    const auto cells = number_cells(triangulation);
    if (cells.size() >= TetMesh::outside_hull)
        throw Error("the tetrahedralisation of {} points has {} cells; at most {} can be numbered", positions.size(),
                    cells.size(), TetMesh::outside_hull - 1)
            .hint("voxel-thin keeps fewer points");
    raw.cells.resize(cells.size());
    raw.neighbours.resize(cells.size());
    for_each_chunk(context.threads(), cells.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            Tetrahedron cell;
            for (int corner = 0; corner < 4; ++corner) cell[corner] = cells[c]->vertex(corner)->info();
            const std::array<int, 4> corners = canonical_corners(cell);
            for (int i = 0; i < 4; ++i) {
                raw.cells[c][i] = cell[corners[i]];
                raw.neighbours[c][i] = cells[c]->neighbor(corners[i])->info();
            }
        }
    });
    return raw;
}

}  // namespace scanmill
