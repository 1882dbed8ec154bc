// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/updated_mesh.hpp"

#include <algorithm>

#include "merge/merge_steps.hpp"
#include "scanmill/filter/inputs.hpp"

namespace scanmill::updating {

namespace {

/// The triangle from its lowest corner on.
Triangle from_lowest(Triangle corners) {
    std::ranges::rotate(corners, std::ranges::min_element(corners));
    return corners;
}

/// By vertex of the model: its group from 1, or Groups::overlap for vertices of overlap facets and without facets.
Array<std::int32_t> group_numbers(const Model& model, const Groups& groups) {
    Array<std::int32_t> numbers(model.mesh.positions.size(), Groups::overlap);
    for (std::size_t facet = 0; facet < groups.of_facet.size(); ++facet)
        if (groups.of_facet[facet] != Groups::overlap)
            for (const u32 vertex : model.mesh.triangles[facet]) numbers[vertex] = groups.of_facet[facet] + 1;
    for (std::size_t facet = 0; facet < groups.of_facet.size(); ++facet)
        if (groups.of_facet[facet] == Groups::overlap)
            for (const u32 vertex : model.mesh.triangles[facet]) numbers[vertex] = Groups::overlap;
    return numbers;
}

/// The vertices, without the columns that an earlier update added and that this one adds again.
PointCloud vertices_of(const TriangleMesh& mesh) {
    PointCloud points = points_of(mesh);
    ColumnTable columns;
    for (const Column& column : points.columns)
        if (column.name() != "group" && column.name() != "replaced") columns.add(column);
    points.columns = std::move(columns);
    return points;
}

/// Adds the columns of all vertices of an update.
void add_columns(TriangleMesh& mesh, Array<std::int32_t> groups, Array<u8> replaced, Array<u8> updated,
                 Context& context) {
    add_column(mesh.vertex_columns, Column("group", 1, Buffer<std::int32_t>(std::move(groups))), context);
    add_column(mesh.vertex_columns, Column("replaced", 1, Buffer<u8>(std::move(replaced))), context);
    add_column(mesh.face_columns, Column("updated", 1, Buffer<u8>(std::move(updated))), context);
}

/// The sharp edges of the model that are edges of the result, as pairs of its vertices.
Array<Edge> kept_sharp_edges(const TriangleMesh& model, const TriangleMesh& result, std::span<const u32> rows) {
    Array<Edge> found;
    if (model.sharp_edges.empty()) return found;
    for (const Triangle& t : result.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const u32 a = t[k], b = t[(k + 1) % 3];
            if (a < b && std::ranges::binary_search(model.sharp_edges, make_edge(rows[a], rows[b])))
                found.push_back({a, b});
        }
    std::ranges::sort(found);
    return found;
}

}  // namespace

Difference difference(const TriangleMesh& model, const Rebuilt& rebuilt) {
    struct Facet {
        Triangle corners;
        u32 row;
        auto operator<=>(const Facet&) const = default;
    };
    std::vector<Facet> old;
    for (const u32 row : rebuilt.replaced) old.push_back({from_lowest(model.triangles[row]), row});
    std::ranges::sort(old);
    std::vector<bool> is_found(old.size());
    Difference result;
    result.is_new.assign(rebuilt.triangles.size(), u8(0));
    for (std::size_t i = rebuilt.fixed; i < rebuilt.triangles.size(); ++i) {
        Triangle corners = rebuilt.triangles[i];
        for (u32& corner : corners) corner = rebuilt.rows[corner];
        corners = from_lowest(corners);
        const auto found = std::ranges::lower_bound(old, corners, {}, &Facet::corners);
        if (found != old.end() && found->corners == corners)
            is_found[static_cast<std::size_t>(found - old.begin())] = true;
        else
            result.is_new[i] = 1;
    }
    for (std::size_t i = 0; i < old.size(); ++i)
        if (!is_found[i]) result.old_facets.push_back(old[i].row);
    std::ranges::sort(result.old_facets);
    return result;
}

TriangleMesh updated_mesh(const Model& model, std::span<const std::shared_ptr<const PointCloud>> clouds,
                          std::span<const Vec3> positions, const Groups& groups, const Rebuilt& rebuilt,
                          std::span<const u8> is_new, Context& context) {
    TriangleMesh mesh;
    mesh.frame = model.mesh.frame;
    Array<Vec3> placed;
    placed.reserve(rebuilt.rows.size());
    for (const u32 row : rebuilt.rows) placed.push_back(positions[row]);
    mesh.positions = std::move(placed);
    mesh.triangles = rebuilt.triangles;
    std::vector<std::shared_ptr<const PointCloud>> all{std::make_shared<const PointCloud>(vertices_of(model.mesh))};
    all.insert(all.end(), clouds.begin(), clouds.end());
    mesh.vertex_columns = merging::merged_columns(all, {}, {}, context).gather(rebuilt.rows);
    ColumnTable faces;
    for (const Column& column : model.mesh.face_columns)
        if (column.name() != "updated") faces.add(column);
    warn_of_dropped(faces, "face columns", "new triangles have no values", context);
    warn_of_dropped(model.mesh.edge_columns, "edge columns", "new edges have no values", context);
    const Array<std::int32_t> numbers = group_numbers(model, groups);
    Array<std::int32_t> group;
    for (const u32 row : rebuilt.rows) group.push_back(row < numbers.size() ? numbers[row] : Groups::overlap);
    add_columns(mesh, std::move(group), Array<u8>(rebuilt.rows.size(), u8(0)), Array<u8>(is_new.begin(), is_new.end()),
                context);
    mesh.sharp_edges = kept_sharp_edges(model.mesh, mesh, rebuilt.rows);
    return mesh;
}

TriangleMesh kept_mesh(const TriangleMesh& given, const Model& model, const Groups& groups,
                       std::span<const u8> would_go, Context& context) {
    TriangleMesh mesh = given;
    const std::size_t vertices = given.positions.size();
    // Resampling appends vertices.
    const std::array<std::shared_ptr<const PointCloud>, 1> all{std::make_shared<const PointCloud>(vertices_of(given))};
    mesh.vertex_columns = merging::merged_columns(all, {}, {}, context);
    Array<std::int32_t> numbers = group_numbers(model, groups);
    numbers.resize(vertices);
    add_columns(mesh, std::move(numbers), Array<u8>(would_go.begin(), would_go.begin() + std::ptrdiff_t(vertices)),
                Array<u8>(given.triangles.size(), u8(0)), context);
    return mesh;
}

}  // namespace scanmill::updating
