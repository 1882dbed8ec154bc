// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/mesh.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

constexpr const char* way_out = "the mesh is damaged: make it again";

void require_rows(const ColumnTable& columns, std::size_t rows, std::string_view element) {
    for (const Column& column : columns)
        if (column.rows() != rows)
            throw Error("column '{}' has {} for {} {}", column.name(), count_text(column.rows(), "row", "rows"), rows,
                        element)
                .hint(way_out);
}

template <class Simplex>
void require_in_range(const Buffer<Simplex>& simplices, std::size_t vertices, std::string_view what) {
    for (std::size_t i = 0; i < simplices.size(); ++i)
        for (u32 vertex : simplices[i])
            if (vertex >= vertices)
                throw Error("{} {} names vertex {}; there are {}", what, i, vertex, vertices).hint(way_out);
}

constexpr u32 removed = ~u32(0);

/// The simplices whose vertices all remain, with the new indices of their vertices. `columns`, if not null, keeps only
/// the rows of these simplices.
template <class Simplex>
Buffer<Simplex> renumbered(const Buffer<Simplex>& simplices, const Array<u32>& new_index, ColumnTable* columns) {
    Array<Simplex> result;
    Array<u32> kept;
    result.reserve(simplices.size());
    kept.reserve(simplices.size());
    for (u32 row = 0; row < simplices.size(); ++row) {
        Simplex simplex = simplices[row];
        for (u32& vertex : simplex) vertex = new_index[vertex];
        if (std::ranges::find(simplex, removed) != simplex.end()) continue;
        result.push_back(simplex);
        kept.push_back(row);
    }
    if (columns && kept.size() < simplices.size()) *columns = columns->gather(kept);
    return result;
}

/// The mesh without all other vertices and the simplices at them. Pre: `vertices` ascend.
TriangleMesh with_vertices(TriangleMesh mesh, const Array<u32>& vertices) {
    Array<u32> new_index(mesh.positions.size(), removed);
    for (u32 i = 0; i < vertices.size(); ++i) new_index[vertices[i]] = i;
    mesh.positions = gather(mesh.positions, vertices);
    mesh.vertex_columns = mesh.vertex_columns.gather(vertices);
    mesh.triangles = renumbered(mesh.triangles, new_index, &mesh.face_columns);
    mesh.edges = renumbered(mesh.edges, new_index, &mesh.edge_columns);
    mesh.sharp_edges = renumbered(mesh.sharp_edges, new_index, nullptr);
    return mesh;
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
    std::vector<bool> is_used(mesh.positions.size());
    for (const Triangle& triangle : mesh.triangles)
        for (u32 vertex : triangle) is_used[vertex] = true;
    Array<u32> used;
    for (u32 vertex = 0; vertex < is_used.size(); ++vertex)
        if (is_used[vertex]) used.push_back(vertex);
    return with_vertices(mesh, used);
}

PointCloud points_of(const TriangleMesh& mesh) { return {mesh.frame, mesh.positions, mesh.vertex_columns}; }

Cleaned<TriangleMesh> without_invalid_points(const TriangleMesh& mesh) {
    const Array<u32> rows = finite_rows(mesh.positions.span());
    if (rows.size() == mesh.positions.size()) return {mesh, 0, 0};
    TriangleMesh clean = with_vertices(mesh, rows);
    const std::size_t triangles = mesh.triangles.size() - clean.triangles.size();
    return {std::move(clean), mesh.positions.size() - rows.size(), triangles};
}

BoundingBox surface_box(const TriangleMesh& mesh) {
    BoundingBox box;
    for (const Triangle& triangle : mesh.triangles)
        for (const u32 vertex : triangle) {
            const Vec3& position = mesh.positions[vertex];
            if (position.allFinite()) box.add(position);
        }
    return box;
}

}  // namespace scanmill
