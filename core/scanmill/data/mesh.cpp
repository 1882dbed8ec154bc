// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/mesh.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

constexpr u32 unused = ~u32(0);

void require_rows(const ColumnTable& columns, std::size_t rows, std::string_view element) {
    for (const Column& column : columns)
        if (column.rows() != rows)
            throw Error("column '{}' has {} for {} {}", column.name(), count_text(column.rows(), "row", "rows"), rows,
                        element);
}

template <class Simplex>
void require_in_range(const Buffer<Simplex>& simplices, std::size_t vertices, std::string_view what) {
    for (std::size_t i = 0; i < simplices.size(); ++i)
        for (u32 vertex : simplices[i])
            if (vertex >= vertices) throw Error("{} {} names vertex {}; there are {}", what, i, vertex, vertices);
}

/// The simplices whose vertices all survive, renumbered; `kept` receives their rows.
Buffer<Edge> renumbered(const Buffer<Edge>& edges, const Array<u32>& new_index, Array<u32>& kept) {
    Array<Edge> result;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const auto [a, b] = edges[i];
        if (new_index[a] == unused || new_index[b] == unused) continue;
        result.push_back({new_index[a], new_index[b]});
        kept.push_back(static_cast<u32>(i));
    }
    return result;
}

}  // namespace

void require_consistent(const TriangleMesh& mesh) {
    const std::size_t vertices = mesh.positions.size();
    require_in_range(mesh.triangles, vertices, "triangle");
    require_in_range(mesh.edges, vertices, "edge");
    require_in_range(mesh.sharp_edges, vertices, "sharp edge");
    require_rows(mesh.vertex_columns, vertices, "vertices");
    require_rows(mesh.face_columns, mesh.triangles.size(), "triangles");
    require_rows(mesh.edge_columns, mesh.edges.size(), "edges");
}

TriangleMesh without_unused_vertices(const TriangleMesh& mesh) {
    Array<u32> new_index(mesh.positions.size());
    std::fill(new_index.begin(), new_index.end(), unused);
    for (const Triangle& triangle : mesh.triangles)
        for (u32 vertex : triangle) new_index[vertex] = 0;
    Array<u32> used;
    for (u32 vertex = 0; vertex < new_index.size(); ++vertex)
        if (new_index[vertex] != unused) {
            new_index[vertex] = static_cast<u32>(used.size());
            used.push_back(vertex);
        }

    TriangleMesh result;
    result.frame = mesh.frame;
    result.positions = gather(mesh.positions, used);
    result.vertex_columns = mesh.vertex_columns.gather(used);
    result.face_columns = mesh.face_columns;
    Array<Triangle> triangles(mesh.triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (int corner = 0; corner < 3; ++corner) triangles[i][corner] = new_index[mesh.triangles[i][corner]];
    result.triangles = std::move(triangles);

    Array<u32> kept_edges, kept_sharp_edges;
    result.edges = renumbered(mesh.edges, new_index, kept_edges);
    result.edge_columns = mesh.edge_columns.gather(kept_edges);
    result.sharp_edges = renumbered(mesh.sharp_edges, new_index, kept_sharp_edges);
    return result;
}

BoundingBox surface_box(const TriangleMesh& mesh) {
    BoundingBox box;
    for (const Triangle& triangle : mesh.triangles)
        for (const u32 vertex : triangle) {
            const Vec3& position = mesh.positions[vertex];
            if (!position.allFinite()) continue;
            box.low = box.low.cwiseMin(position);
            box.high = box.high.cwiseMax(position);
        }
    return box;
}

}  // namespace scanmill
