// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/distance/sides.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/distance/enclosed.hpp"

namespace scanmill {

namespace {

constexpr double rounding = 1e-9;
/// Depth of an inner point below its triangle, as a share of the triangle's size.
constexpr double depth = 1e-6;

/// A closed component.
struct Shell {
    Array<Triangle> triangles;
    std::vector<u32> rows;
    BoundingBox box;
    /// Six times the enclosed volume, and the sum of the absolute values of its parts.
    double volume = 0, parts = 0;
    std::size_t around = 0;  ///< number of shells that enclose it

    /// A point just inside, below the middle of the largest triangle: not on a shell that only touches this one.
    Vec3 inner_point(const TriangleMesh& mesh) const {
        Vec3 normal = Vec3::Zero(), middle = mesh.positions[triangles[0][0]];
        for (const auto& [a, b, c] : triangles) {
            const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
            const Vec3 its = (q - p).cross(r - p);
            if (!(its.squaredNorm() > normal.squaredNorm())) continue;
            normal = its;
            middle = p + ((q - p) + (r - p)) / 3;
        }
        const double twice_area = normal.norm();
        if (!(twice_area > 0)) return middle;
        return middle - normal * ((volume > 0 ? depth : -depth) * std::sqrt(twice_area) / twice_area);
    }
    bool faces_wrong() const { return std::abs(volume) > rounding * parts && (volume > 0) != (around % 2 == 0); }
};

void add(Shell& shell, const TriangleMesh& mesh, u32 row) {
    const auto& [a, b, c] = mesh.triangles[row];
    shell.rows.push_back(row);
    shell.triangles.push_back({a, b, c});
    const Vec3& origin = mesh.positions[shell.triangles[0][0]];
    const Vec3 to_b = mesh.positions[b] - origin, to_c = mesh.positions[c] - origin;
    const double part = (mesh.positions[a] - origin).dot(to_b.cross(to_c));
    shell.volume += part;
    shell.parts += std::abs(part);
    for (const u32 vertex : {a, b, c}) shell.box.add(mesh.positions[vertex]);
}

/// In the order of their first triangles.
std::vector<Shell> shells_of(const TriangleMesh& mesh) {
    DisjointSets components(mesh.triangles.size());
    std::vector<u32> at_open_edges;
    half_edges::for_each_edge(half_edges::by_smaller_vertex(mesh), [&](u32 vertex, auto edge) {
        for (const auto& it : edge) components.unite(edge.front().number / 3, it.number / 3);
        const auto is_outgoing = [&](const auto& it) { return half_edges::start(mesh, it.number) == vertex; };
        if (edge.size() != 2 || is_outgoing(edge[0]) == is_outgoing(edge[1]))
            at_open_edges.push_back(edge.front().number / 3);
    });
    std::vector<bool> is_open(mesh.triangles.size(), false);
    for (const u32 row : at_open_edges) is_open[components.find(row)] = true;
    std::vector<u32> number(mesh.triangles.size());  // by representative, which is the first triangle
    std::vector<Shell> shells;
    for (u32 row = 0; row < mesh.triangles.size(); ++row) {
        const u32 first = components.find(row);
        if (is_open[first] || half_edges::has_repeated_vertex(mesh.triangles[row])) continue;
        if (first == row) {
            number[row] = static_cast<u32>(shells.size());
            shells.emplace_back();
        }
        add(shells[number[first]], mesh, row);
    }
    return shells;
}

bool is_within(const BoundingBox& inner, const BoundingBox& outer) {
    return (inner.low.array() >= outer.low.array()).all() && (inner.high.array() <= outer.high.array()).all();
}

void count_enclosing(std::vector<Shell>& shells, const TriangleMesh& mesh, Execution& execution) {
    if (shells.size() < 2) return;
    std::vector<std::pair<Shell*, Vec3>> by_x;
    for (Shell& shell : shells) by_x.emplace_back(&shell, shell.inner_point(mesh));
    std::ranges::sort(by_x, {}, [](const auto& it) { return std::pair(it.first->box.low.x(), it.first->rows[0]); });
    for (const Shell& outer : shells) {
        execution.check_cancelled();
        std::vector<Shell*> candidates;
        Array<Vec3> points;
        auto next =
            std::ranges::lower_bound(by_x, outer.box.low.x(), {}, [](const auto& it) { return it.first->box.low.x(); });
        for (; next != by_x.end() && next->first->box.low.x() <= outer.box.high.x(); ++next) {
            const auto& [inner, point] = *next;
            if (std::abs(outer.volume) <= std::abs(inner->volume) || !is_within(inner->box, outer.box)) continue;
            candidates.push_back(inner);
            points.push_back(point);
        }
        if (candidates.empty()) continue;
        const TriangleTree tree(mesh.positions.span(), outer.triangles, execution.threads());
        const Array<u8> inside = enclosed(points, mesh.positions.span(), outer.triangles, tree, execution);
        for (std::size_t i = 0; i < candidates.size(); ++i) candidates[i]->around += inside[i];
    }
}

/// The column with the normals of each marked row negated, and the second and third normal of a row of three swapped.
template <class Number>
Column reversed(const Column& column, std::span<const u8> marked) {
    const std::span<const Number> old = column.values<Number>();
    Array<Number> values(old.begin(), old.end());
    const std::size_t width = column.components();
    for (std::size_t row = 0; row < marked.size(); ++row) {
        if (marked[row] == 0) continue;
        const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row * width);
        for (std::size_t i = 0; i < width; ++i) begin[static_cast<std::ptrdiff_t>(i)] *= -1;
        if (width == 9) std::swap_ranges(begin + 3, begin + 6, begin + 6);
    }
    return {column.name(), column.components(), Buffer<Number>(std::move(values))};
}

void reverse(ColumnTable& columns, std::string_view name, u32 components, std::span<const u8> marked) {
    ColumnTable result;
    for (const Column& column : columns) {
        const bool is_it = column.name() == name && column.components() == components;
        if (is_it && column.type() == ScalarType::float32)
            result.add(reversed<float>(column, marked));
        else if (is_it && column.type() == ScalarType::float64)
            result.add(reversed<double>(column, marked));
        else
            result.add(column);
    }
    columns = std::move(result);
}

}  // namespace

Array<u8> facing_wrong(const TriangleMesh& mesh, Execution& execution) {
    std::vector<Shell> shells = shells_of(mesh);
    count_enclosing(shells, mesh, execution);
    Array<u8> wrong(mesh.triangles.size(), u8(0));
    for (const Shell& shell : shells)
        if (shell.faces_wrong())
            for (const u32 row : shell.rows) wrong[row] = 1;
    return wrong;
}

std::size_t face_outwards(TriangleMesh& mesh, Execution& execution) {
    const Array<u8> wrong = facing_wrong(mesh, execution);
    const auto count = static_cast<std::size_t>(std::ranges::count(wrong, u8(1)));
    if (count == 0) return 0;
    Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    Array<u8> vertices(mesh.positions.size(), u8(0));
    for (std::size_t row = 0; row < wrong.size(); ++row) {
        if (wrong[row] == 0) continue;
        for (const u32 vertex : triangles[row]) vertices[vertex] = 1;
        std::swap(triangles[row][1], triangles[row][2]);
    }
    mesh.triangles = std::move(triangles);
    reverse(mesh.vertex_columns, "normal", 3, vertices);
    reverse(mesh.face_columns, "corner-normals", 9, wrong);
    return count;
}

}  // namespace scanmill
