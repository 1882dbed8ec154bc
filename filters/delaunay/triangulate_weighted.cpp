// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Regular_triangulation_3.h>
#include <CGAL/Regular_triangulation_cell_base_3.h>
#include <CGAL/Regular_triangulation_vertex_base_3.h>

#include <cassert>

#include "delaunay/cell_containers.hpp"
#include "delaunay/insertion_order.hpp"
#include "delaunay/raw_cells.hpp"

namespace scanmill {

namespace {

// Points that become hidden are dropped: whoever is in no cell in the end is hidden.
using WeightedCellBase = CGAL::Regular_triangulation_cell_base_3<Kernel, CGAL::Triangulation_cell_base_3<Kernel>,
                                                                 CGAL::Discard_hidden_points>;
using WeightedCell = NumberedCellBase<Kernel, WeightedCellBase>;
using WeightedVertex = RowVertexBase<Kernel, CGAL::Regular_triangulation_vertex_base_3<Kernel>>;
using Weighted =
    CGAL::Regular_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<WeightedVertex, WeightedCell>>;

static_assert(std::is_base_of_v<LoneContainer<Weighted::Cell>, Weighted::Triangulation_data_structure::Cell_range>);
static_assert(std::is_base_of_v<LoneContainer<Weighted::Vertex>, Weighted::Triangulation_data_structure::Vertex_range>);

void insert_all(Weighted& triangulation, std::span<const PointRow> points, std::span<const double> weights,
                std::span<const u8> is_duplicate, Context& context) {
    Weighted::Vertex_handle last;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i % 256 == 0) {
            context.check_cancelled();
            context.progress(0.25 + 0.55 * static_cast<double>(i) / static_cast<double>(points.size()));
        }
        const auto& [point, row] = points[i];
        if (is_duplicate[row]) continue;
        const Weighted::Vertex_handle vertex = triangulation.insert({point, weights[row]}, last);
        if (vertex == Weighted::Vertex_handle()) continue;  // hidden at once
        vertex->info().row = row;
        last = vertex;
    }
}

}  // namespace

RawTriangulation triangulate_weighted(std::span<const Vec3> positions, std::span<const double> weights,
                                      Array<u32> duplicates, Context& context) {
    assert(weights.size() == positions.size());
    RawTriangulation raw;
    raw.duplicates = std::move(duplicates);
    Array<u8> is_duplicate(positions.size());
    std::ranges::fill(is_duplicate, u8(0));
    for (u32 row : raw.duplicates) is_duplicate[row] = 1;

    Weighted triangulation;
    insert_all(triangulation, insertion_order(positions, context.threads()), weights, is_duplicate, context);
    raw.dimension = triangulation.dimension();
    if (raw.dimension == 3) fill_cells(triangulation, positions.size(), context.threads(), raw);
    return raw;
}

}  // namespace scanmill
