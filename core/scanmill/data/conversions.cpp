// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/conversions.hpp"

#include <algorithm>

namespace scanmill {

namespace {

constexpr u32 gone = ~u32(0);

Array<u32> finite_rows(const Buffer<Vec3>& positions) {
    Array<u32> rows;
    rows.reserve(positions.size());
    for (u32 row = 0; row < positions.size(); ++row)
        if (positions[row].allFinite()) rows.push_back(row);
    return rows;
}

/// The simplices whose vertices all stay, renumbered; `kept` receives their rows.
template <class Simplex>
Array<Simplex> renumbered(const Buffer<Simplex>& simplices, const Array<u32>& new_number, Array<u32>& kept) {
    Array<Simplex> result;
    for (u32 row = 0; row < simplices.size(); ++row) {
        Simplex simplex = simplices[row];
        for (u32& vertex : simplex) vertex = new_number[vertex];
        if (std::ranges::find(simplex, gone) != simplex.end()) continue;
        result.push_back(simplex);
        kept.push_back(row);
    }
    return result;
}

}  // namespace

PointCloud points_of(const TriangleMesh& mesh) { return {mesh.frame, mesh.positions, mesh.vertex_columns}; }

Cleaned<PointCloud> without_invalid_points(const PointCloud& cloud) {
    const Array<u32> rows = finite_rows(cloud.positions);
    if (rows.size() == cloud.size()) return {cloud, 0, 0};
    return {gather(cloud, rows), cloud.size() - rows.size(), 0};
}

Cleaned<TriangleMesh> without_invalid_points(const TriangleMesh& mesh) {
    const Array<u32> rows = finite_rows(mesh.positions);
    if (rows.size() == mesh.positions.size()) return {mesh, 0, 0};
    Array<u32> new_number(mesh.positions.size(), gone);
    for (u32 i = 0; i < rows.size(); ++i) new_number[rows[i]] = i;

    Array<u32> faces, edges, sharp_edges;
    TriangleMesh clean;
    clean.frame = mesh.frame;
    clean.positions = gather(mesh.positions, rows);
    clean.vertex_columns = mesh.vertex_columns.gather(rows);
    clean.triangles = renumbered(mesh.triangles, new_number, faces);
    clean.face_columns = mesh.face_columns.gather(faces);
    clean.edges = renumbered(mesh.edges, new_number, edges);
    clean.edge_columns = mesh.edge_columns.gather(edges);
    clean.sharp_edges = renumbered(mesh.sharp_edges, new_number, sharp_edges);
    return {std::move(clean), mesh.positions.size() - rows.size(), mesh.triangles.size() - faces.size()};
}

}  // namespace scanmill
