// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/topology.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"

namespace scanmill {

using half_edges::after, half_edges::before;

namespace {

constexpr u32 none = ~u32(0);

/// Whether the fan of triangles around the vertex of `corner` that contains `corner` has exactly `corners` corners.
/// Pre: no edge at the vertex is in more than two triangles.
bool fan_has(const TriangleMesh& mesh, const std::vector<u32>& opposite, u32 corner, u32 corners) {
    const u32 vertex = half_edges::start(mesh, corner);
    u32 visited = 1;
    for (const u32 first : {corner, before(corner)}) {
        for (u32 half_edge = first; opposite[half_edge] != none; ++visited) {
            const u32 other = opposite[half_edge];
            const bool starts_here = half_edges::start(mesh, other) == vertex;
            const u32 here = starts_here ? other : after(other);
            if (here == corner) return visited == corners;
            half_edge = starts_here ? before(other) : here;
        }
    }
    return visited == corners;
}

}  // namespace

MeshTopology topology(const TriangleMesh& mesh) {
    MeshTopology result;
    result.triangles = mesh.triangles.size();
    std::vector<bool> used(mesh.positions.size(), false);
    std::vector<bool> unmanifold(mesh.positions.size(), false);
    for (const Triangle& triangle : mesh.triangles) {
        if (half_edges::has_repeated_vertex(triangle)) ++result.degenerate_triangles;
        for (u32 vertex : triangle) used[vertex] = true;
    }
    result.vertices = static_cast<std::size_t>(std::ranges::count(used, true));
    result.unused_vertices = used.size() - result.vertices;

    std::vector<u32> opposite(3 * mesh.triangles.size(), none);  // for edges in exactly two triangles
    DisjointSets faces(mesh.triangles.size());
    DisjointSets boundary(mesh.positions.size());
    std::vector<bool> on_boundary(mesh.positions.size(), false);
    half_edges::for_each_edge(half_edges::by_smaller_vertex(mesh), [&](u32 a, auto edge) {
        const u32 b = edge[0].other, half_edge = edge[0].number;
        for (const auto& other : edge) faces.unite(half_edge / 3, other.number / 3);
        ++result.edges;
        if (edge.size() == 1) {
            ++result.boundary_edges;
            boundary.unite(a, b);
            on_boundary[a] = on_boundary[b] = true;
        } else if (edge.size() > 2) {
            ++result.nonmanifold_edges;
            unmanifold[a] = unmanifold[b] = true;
        } else {
            const u32 other = edge[1].number;
            opposite[half_edge] = other;
            opposite[other] = half_edge;
            if (half_edges::start(mesh, half_edge) == half_edges::start(mesh, other)) ++result.misoriented_edges;
        }
    });

    std::vector<u32> corner_of(mesh.positions.size(), none), corners(mesh.positions.size(), 0);
    for (u32 t = 0; t < mesh.triangles.size(); ++t) {
        if (half_edges::has_repeated_vertex(mesh.triangles[t])) continue;
        if (faces.find(t) == t) ++result.components;
        for (u32 i = 0; i < 3; ++i) {
            const u32 vertex = mesh.triangles[t][i];
            corner_of[vertex] = 3 * t + i;
            ++corners[vertex];
        }
    }
    for (u32 vertex = 0; vertex < mesh.positions.size(); ++vertex)
        if (corners[vertex] > 0 && !unmanifold[vertex])
            unmanifold[vertex] = !fan_has(mesh, opposite, corner_of[vertex], corners[vertex]);
    result.nonmanifold_vertices = static_cast<std::size_t>(std::ranges::count(unmanifold, true));
    for (u32 vertex = 0; vertex < on_boundary.size(); ++vertex)
        if (on_boundary[vertex] && boundary.find(vertex) == vertex) ++result.boundary_loops;

    result.euler = static_cast<long>(result.vertices) - static_cast<long>(result.edges) +
                   static_cast<long>(result.triangles - result.degenerate_triangles);
    const bool manifold = result.triangles > 0 && result.degenerate_triangles == 0 && result.nonmanifold_edges == 0 &&
                          result.nonmanifold_vertices == 0 && result.misoriented_edges == 0;
    result.closed = manifold && result.boundary_edges == 0;
    if (manifold)
        result.genus =
            static_cast<long>(result.components) - (result.euler + static_cast<long>(result.boundary_loops)) / 2;
    return result;
}

double signed_volume(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
    if (triangles.empty()) return 0;
    const Vec3& apex = positions[triangles[0][0]];
    double sum = 0;
    for (const auto& [a, b, c] : triangles)
        sum += (positions[a] - apex).dot((positions[b] - apex).cross(positions[c] - apex));
    return sum / 6;
}

bool is_inside_out(const TriangleMesh& mesh) {
    constexpr double rounding = 1e-9;
    const double volume = signed_volume(mesh.positions.span(), mesh.triangles.span());
    if (!(volume < 0)) return false;
    double parts = 0;
    const Vec3& apex = mesh.positions[mesh.triangles[0][0]];
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 to_b = mesh.positions[b] - apex, to_c = mesh.positions[c] - apex;
        parts += std::abs((mesh.positions[a] - apex).dot(to_b.cross(to_c)));
    }
    return -6 * volume > rounding * parts && topology(mesh).closed;
}

std::string defects_text(const MeshTopology& found) {
    std::vector<std::string> defects;
    const auto add = [&](std::size_t count, const char* singular, const char* plural, const std::string& rest) {
        if (count > 0) defects.push_back(count_text(count, singular, plural) + rest);
    };
    add(found.boundary_edges, "boundary edge", "boundary edges",
        " in " + count_text(found.boundary_loops, "loop", "loops"));
    add(found.nonmanifold_edges, "edge", "edges", " in three or more triangles");
    add(found.misoriented_edges, "edge", "edges", " between triangles of opposite orientation");
    add(found.nonmanifold_vertices, "vertex", "vertices", " with several fans of triangles");
    add(found.degenerate_triangles, "triangle", "triangles", " with a repeated vertex");
    return enumerated(defects);
}

}  // namespace scanmill
