// SPDX-License-Identifier: GPL-3.0-or-later
#include "fill_holes/filled_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

constexpr u32 invalid_index = ~u32(0);

/// Copies `column` with the vectors `added` in its last rows; a vector is repeated to fill a row. A row whose vector is
/// 0 keeps its values.
template <class Number>
Column with_directions(const Column& column, std::span<const Vec3> added) {
    const std::span<const Number> old = column.values<Number>();
    Array<Number> values(old.begin(), old.end());
    const std::size_t width = column.components(), first = column.rows() - added.size();
    for (std::size_t i = 0; i < added.size(); ++i)
        for (std::size_t k = 0; k < width && !added[i].isZero(0); ++k)
            values[(first + i) * width + k] = static_cast<Number>(added[i][static_cast<Eigen::Index>(k % 3)]);
    return {column.name(), column.components(), Buffer<Number>(std::move(values))};
}

/// Gathers the columns at `rows`. The last rows of the column `name` get the directions `added`. The column `filled` is
/// 1 for the rows in `marks`, and for rows that the input marks.
ColumnTable extended(const ColumnTable& columns, const Array<u32>& rows, std::string_view name, u32 width,
                     std::span<const Vec3> added, std::span<const u8> marks, std::string_view element,
                     Context& context) {
    ColumnTable result;
    Array<u8> filled(rows.size(), 0);
    for (const Column& column : columns.gather(rows)) {
        if (column.name() == "filled") {
            if (column.components() == 1 && column.type() == ScalarType::uint8)
                std::ranges::copy(column.values<u8>(), filled.begin());
            else
                context.warn(fmt::format(
                    "the {} column 'filled' of the input is replaced: it does not have one uint8 per row", element));
        } else if (column.name() == name && column.components() == width && column.type() == ScalarType::float32) {
            result.add(with_directions<float>(column, added));
        } else if (column.name() == name && column.components() == width && column.type() == ScalarType::float64) {
            result.add(with_directions<double>(column, added));
        } else {
            result.add(column);
        }
    }
    for (std::size_t i = 0; i < filled.size(); ++i) filled[i] |= marks[i];
    result.add(Column("filled", 1, Buffer<u8>(std::move(filled))));
    return result;
}

std::set<Edge> edges_of(std::span<const Triangle> triangles) {
    std::set<Edge> edges;
    for (const Triangle& triangle : triangles)
        for (std::size_t i = 0; i < 3; ++i) edges.insert(make_edge(triangle[i], triangle[(i + 1) % 3]));
    return edges;
}

/// Removes sharp edges and rows of edge columns whose edges do not exist.
void keep_edges(TriangleMesh& mesh) {
    if (mesh.sharp_edges.empty() && mesh.edges.empty()) return;
    const std::set<Edge> existing = edges_of(mesh.triangles.span());
    Array<Edge> sharp, edges;
    Array<u32> rows;
    for (const Edge& edge : mesh.sharp_edges)
        if (existing.contains(edge)) sharp.push_back(edge);
    for (u32 row = 0; row < mesh.edges.size(); ++row)
        if (existing.contains(make_edge(mesh.edges[row][0], mesh.edges[row][1]))) {
            edges.push_back(mesh.edges[row]);
            rows.push_back(row);
        }
    mesh.sharp_edges = std::move(sharp);
    mesh.edges = std::move(edges);
    mesh.edge_columns = mesh.edge_columns.gather(rows);
}

/// Removes the vertices from `first` to `last` - 1 that no triangle uses.
void drop_unused(FilledMesh& filled, Array<Triangle>& triangles, std::size_t first, std::size_t last) {
    std::vector<bool> is_used(filled.positions.size(), false);
    for (const Triangle& triangle : triangles)
        for (const u32 vertex : triangle) is_used[vertex] = true;
    std::vector<u32> number(filled.positions.size());
    u32 count = 0;
    for (u32 v = 0; v < number.size(); ++v) {
        number[v] = count;
        if (v >= first && v < last && !is_used[v]) continue;
        filled.positions[count] = Vec3(filled.positions[v]);
        filled.vertex_rows[count++] = u32(filled.vertex_rows[v]);
    }
    filled.positions.resize(count);
    filled.vertex_rows.resize(count);
    for (Triangle& triangle : triangles)
        for (u32& vertex : triangle) vertex = number[vertex];
}

}  // namespace

Vec3 FilledMesh::twice_area(std::size_t t) const {
    const auto& [a, b, c] = triangles[t];
    return (positions[b] - positions[a]).cross(positions[c] - positions[a]);
}

double FilledMesh::area() const {
    double area = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t) area += twice_area(t).norm() / 2;
    return area;
}

double FilledMesh::filled_area() const {
    double area = -replaced_area;
    for (std::size_t t = 0; t < triangles.size(); ++t)
        if (filled[t]) area += twice_area(t).norm() / 2;
    return std::max(area, 0.0);
}

FilledMesh filled_mesh(const TriangleMesh& mesh, Assembly all, std::span<const Hole> holes) {
    const std::size_t vertices = mesh.positions.size(), triangles = mesh.triangles.size();
    FilledMesh rows;
    rows.vertex_rows.resize(vertices);
    rows.triangle_rows.resize(triangles);
    std::iota(rows.vertex_rows.begin(), rows.vertex_rows.end(), 0);
    std::iota(rows.triangle_rows.begin(), rows.triangle_rows.end(), 0);
    rows.vertex_rows.resize(all.positions.size(), invalid_index);
    std::size_t first = triangles;
    for (const Hole& hole : holes) {
        if (hole.triangles.empty()) continue;
        const std::size_t last = first + hole.triangles.size();
        // Searches breadth first from the loop. Every vertex takes the loop slot of the vertex that reaches it first.
        std::unordered_map<u32, u32> slot;
        std::unordered_map<u32, std::vector<u32>> beside;
        for (std::size_t t = first; t < last; ++t)
            for (int i = 0; i < 3; ++i)
                for (const int j : {(i + 1) % 3, (i + 2) % 3})
                    beside[all.triangles[t][static_cast<std::size_t>(i)]].push_back(
                        all.triangles[t][static_cast<std::size_t>(j)]);
        std::vector<u32> queue;
        for (u32 i = 0; i < hole.loop.size(); ++i) {
            queue.push_back(half_edges::start(mesh, hole.loop[i]));
            slot[queue.back()] = i;
        }
        for (std::size_t head = 0; head < queue.size(); ++head)
            for (const u32 vertex : beside[queue[head]])
                if (slot.try_emplace(vertex, slot.at(queue[head])).second) queue.push_back(vertex);
        for (const u32 vertex : queue)
            if (vertex >= vertices) rows.vertex_rows[vertex] = half_edges::start(mesh, hole.loop[slot.at(vertex)]);
        for (std::size_t t = first; t < last; ++t) {
            u32 least = invalid_index;
            for (const u32 vertex : all.triangles[t]) least = std::min(least, slot.at(vertex));
            rows.triangle_rows.push_back(hole.loop[least] / 3);
        }
        first = last;
    }
    rows.kept = triangles;
    rows.filled.assign(all.triangles.size(), 1);
    std::fill_n(rows.filled.begin(), triangles, u8{0});
    rows.positions = std::move(all.positions);
    rows.triangles = std::move(all.triangles);
    return rows;
}

std::size_t replace_triangles(FilledMesh& filled, const ClosingSolid& closed, std::size_t first_new) {
    const u32 vertices = static_cast<u32>(filled.positions.size());
    const auto original = [&](Triangle triangle) {
        for (u32& vertex : triangle)
            if (vertex >= vertices) vertex = closed.copies[vertex - vertices];
        return triangle;
    };
    const u32 count = static_cast<u32>(filled.triangles.size());
    const auto original_edge = [&](const Edge& edge) {
        const Triangle ends = original({edge[0], edge[1], 0});
        return make_edge(ends[0], ends[1]);
    };
    std::map<Edge, u32> uses;
    std::vector<u32> at_vertex(filled.positions.size(), invalid_index);  // by vertex: its first triangle
    std::vector<std::pair<Triangle, u32>> rows;
    for (u32 t = 0; t < count; ++t) {
        rows.emplace_back(smallest_first(filled.triangles[t]), t);
        for (std::size_t i = 0; i < 3; ++i) {
            ++uses[make_edge(filled.triangles[t][i], filled.triangles[t][(i + 1) % 3])];
            u32& first = at_vertex[filled.triangles[t][i]];
            first = std::min(first, t);
        }
    }
    std::ranges::sort(rows);
    constexpr Triangle none{invalid_index, invalid_index, invalid_index};
    std::vector<Triangle> stays(count, none), added;  // `stays`: by old triangle, its corners with copies
    for (const Triangle& triangle : closed.triangles) {
        const Triangle key = smallest_first(original(triangle));
        const auto found = std::ranges::lower_bound(rows, std::pair(key, u32(0)));
        if (found == rows.end() || found->first != key) {
            added.push_back(triangle);
            continue;
        }
        // The corners keep their order.
        const Triangle corners = original(triangle);
        for (std::size_t k = 0; k < 3; ++k)
            stays[found->second][k] = triangle[static_cast<std::size_t>(
                std::ranges::find(corners, filled.triangles[found->second][k]) - corners.begin())];
    }
    DisjointSets patches(added.size());
    std::map<Edge, u32> beside;
    for (u32 t = 0; t < added.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [found, is_new] = beside.try_emplace(make_edge(added[t][i], added[t][(i + 1) % 3]), t);
            if (!is_new) patches.unite(t, found->second);
        }
    std::vector<bool> fills(added.size(), false);
    for (const auto& [edge, t] : beside)
        if (const auto found = uses.find(original_edge(edge)); found != uses.end() && found->second == 1)
            fills[patches.find(t)] = true;

    Array<Triangle> triangles;
    Array<u32> sources;
    Array<u8> marks;
    std::size_t kept = 0;
    for (u32 t = 0; t < count; ++t) {
        if (stays[t] == none) {
            if (t < filled.kept) filled.replaced_area += filled.twice_area(t).norm() / 2;
            continue;
        }
        kept += t < filled.kept;
        triangles.push_back(stays[t]);
        sources.push_back(filled.triangle_rows[t]);
        marks.push_back(filled.filled[t]);
    }
    for (u32 t = 0; t < added.size(); ++t) {
        triangles.push_back(added[t]);
        sources.push_back(filled.triangle_rows[at_vertex[std::ranges::min(original(added[t]))]]);
        marks.push_back(fills[patches.find(t)]);
    }
    for (const u32 vertex : closed.copies) {
        filled.positions.push_back(Vec3(filled.positions[vertex]));
        filled.vertex_rows.push_back(u32(filled.vertex_rows[vertex]));
    }
    filled.copies = closed.copies.size();
    drop_unused(filled, triangles, first_new, vertices);
    const std::size_t left_out = filled.kept - kept;
    filled.triangles = std::move(triangles);
    filled.triangle_rows = std::move(sources);
    filled.filled = std::move(marks);
    filled.kept = kept;
    return left_out;
}

TriangleMesh with_columns(const TriangleMesh& mesh, FilledMesh filled, Context& context) {
    const std::size_t vertices = mesh.positions.size();
    const std::size_t copies = filled.positions.size() - filled.copies;  // the first copy
    std::vector<Vec3> facet_normals, vertex_normals(filled.positions.size() - vertices, Vec3::Zero());
    for (std::size_t t = filled.kept; t < filled.triangles.size(); ++t) {
        const Vec3 normal = filled.twice_area(t);
        facet_normals.push_back(normal.stableNormalized());
        for (const u32 vertex : filled.triangles[t])
            if (vertex >= vertices && vertex < copies) vertex_normals[vertex - vertices] += normal;
    }
    for (Vec3& normal : vertex_normals) normal.stableNormalize();
    Array<u8> new_vertices(filled.positions.size(), 0);
    std::fill(new_vertices.begin() + static_cast<std::ptrdiff_t>(vertices),
              new_vertices.begin() + static_cast<std::ptrdiff_t>(copies), u8{1});
    TriangleMesh result = mesh;
    result.vertex_columns =
        extended(mesh.vertex_columns, filled.vertex_rows, "normal", 3, vertex_normals, new_vertices, "vertex", context);
    result.face_columns = extended(mesh.face_columns, filled.triangle_rows, "corner-normals", 9, facet_normals,
                                   filled.filled, "face", context);
    const bool replaces = filled.kept < mesh.triangles.size();
    if (!replaces && filled.kept == filled.triangles.size()) return result;
    result.positions = std::move(filled.positions);
    result.triangles = std::move(filled.triangles);
    if (replaces) keep_edges(result);
    return result;
}

}  // namespace scanmill
