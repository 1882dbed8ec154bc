// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/topology.hpp"

#include <algorithm>
#include <numeric>
#include <span>

#include "scanmill/geometry/disjoint_sets.hpp"

namespace scanmill {

namespace {

bool is_degenerate(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

// A side has the number 3 t + i: the one of triangle t from its corner i to the next. So has that corner.
u32 after(u32 side) { return side % 3 == 2 ? side - 2 : side + 1; }
u32 before(u32 side) { return side % 3 == 0 ? side + 2 : side - 1; }
u32 vertex_at(const TriangleMesh& mesh, u32 corner) { return mesh.triangles[corner / 3][corner % 3]; }

constexpr u32 none = ~u32(0);

struct Side {
    u32 other;  ///< the edge's larger vertex
    u32 number;
};

/// The sides of proper triangles, by the smaller vertex of their edges.
struct SidesOfVertices {
    std::vector<u32> begin;  ///< where a vertex's sides begin, and one more
    std::vector<Side> sides;  ///< of one vertex: by edge, then by number
};

/// By edge, then by number. Pre: they stand by number, and all have one smaller vertex.
void sort_by_edge(std::span<Side> sides) {
    constexpr std::size_t few = 32;
    if (sides.size() > few) {
        std::ranges::stable_sort(sides, {}, &Side::other);
        return;
    }
    for (std::size_t i = 1; i < sides.size(); ++i) {
        const Side side = sides[i];
        std::size_t place = i;
        for (; place > 0 && sides[place - 1].other > side.other; --place) sides[place] = sides[place - 1];
        sides[place] = side;
    }
}

SidesOfVertices sides_of_vertices(const TriangleMesh& mesh) {
    SidesOfVertices result;
    std::vector<u32>& begin = result.begin;
    begin.resize(mesh.positions.size() + 1);
    const auto for_each_side = [&](auto&& action) {
        for (u32 t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle& triangle = mesh.triangles[t];
            if (is_degenerate(triangle)) continue;
            for (u32 i = 0; i < 3; ++i) action(3 * t + i, triangle[i], triangle[i == 2 ? 0 : i + 1]);
        }
    };
    for_each_side([&](u32, u32 a, u32 b) { ++begin[std::min(a, b)]; });
    std::exclusive_scan(begin.begin(), begin.end(), begin.begin(), u32(0));
    result.sides.resize(begin.back());
    std::vector<u32> next(begin.begin(), begin.end() - 1);
    for_each_side([&](u32 side, u32 a, u32 b) { result.sides[next[std::min(a, b)]++] = {std::max(a, b), side}; });
    for (std::size_t vertex = 0; vertex + 1 < begin.size(); ++vertex)
        sort_by_edge({result.sides.data() + begin[vertex], result.sides.data() + begin[vertex + 1]});
    return result;
}

/// Whether the corner's fan, found by going around its vertex from triangle to triangle, has so many corners. Pre: no
/// edge at the vertex is in more than two triangles.
bool fan_has(const TriangleMesh& mesh, const std::vector<u32>& twins, u32 corner, u32 corners) {
    const u32 vertex = vertex_at(mesh, corner);
    u32 seen = 1;
    for (const u32 first : {corner, before(corner)}) {
        for (u32 side = first; twins[side] != none; ++seen) {
            const u32 twin = twins[side];
            const bool starts_here = vertex_at(mesh, twin) == vertex;
            const u32 here = starts_here ? twin : after(twin);
            if (here == corner) return seen == corners;
            side = starts_here ? before(twin) : here;
        }
    }
    return seen == corners;
}

}  // namespace

MeshTopology topology(const TriangleMesh& mesh) {
    MeshTopology facts;
    facts.triangles = mesh.triangles.size();
    std::vector<bool> used(mesh.positions.size(), false);
    std::vector<bool> unmanifold(mesh.positions.size(), false);
    for (const Triangle& triangle : mesh.triangles) {
        if (is_degenerate(triangle)) ++facts.degenerate_triangles;
        for (u32 vertex : triangle) used[vertex] = true;
    }
    facts.vertices = static_cast<std::size_t>(std::ranges::count(used, true));
    facts.unused_vertices = used.size() - facts.vertices;

    const SidesOfVertices by_vertex = sides_of_vertices(mesh);
    std::vector<u32> twins(3 * mesh.triangles.size(), none);  // across edges of two triangles
    DisjointSets faces(mesh.triangles.size());
    DisjointSets boundary(mesh.positions.size());
    std::vector<bool> on_boundary(mesh.positions.size(), false);
    for (u32 a = 0; a < mesh.positions.size(); ++a)
        for (u32 first = by_vertex.begin[a], last; first < by_vertex.begin[a + 1]; first = last) {
            const u32 b = by_vertex.sides[first].other, side = by_vertex.sides[first].number;
            for (last = first + 1; last < by_vertex.begin[a + 1] && by_vertex.sides[last].other == b; ++last)
                faces.unite(side / 3, by_vertex.sides[last].number / 3);
            ++facts.edges;
            if (last - first == 1) {
                ++facts.boundary_edges;
                boundary.unite(a, b);
                on_boundary[a] = on_boundary[b] = true;
            } else if (last - first > 2) {
                ++facts.nonmanifold_edges;
                unmanifold[a] = unmanifold[b] = true;
            } else {
                const u32 twin = by_vertex.sides[first + 1].number;
                twins[side] = twin;
                twins[twin] = side;
                if (vertex_at(mesh, side) == vertex_at(mesh, twin)) ++facts.misoriented_edges;
            }
        }

    std::vector<u32> corner_of(mesh.positions.size(), none), corners(mesh.positions.size(), 0);
    for (u32 t = 0; t < mesh.triangles.size(); ++t) {
        if (is_degenerate(mesh.triangles[t])) continue;
        if (faces.find(t) == t) ++facts.components;
        for (u32 i = 0; i < 3; ++i) {
            const u32 vertex = mesh.triangles[t][i];
            corner_of[vertex] = 3 * t + i;
            ++corners[vertex];
        }
    }
    for (u32 vertex = 0; vertex < mesh.positions.size(); ++vertex)
        if (corners[vertex] > 0 && !unmanifold[vertex])
            unmanifold[vertex] = !fan_has(mesh, twins, corner_of[vertex], corners[vertex]);
    facts.nonmanifold_vertices = static_cast<std::size_t>(std::ranges::count(unmanifold, true));
    for (u32 vertex = 0; vertex < on_boundary.size(); ++vertex)
        if (on_boundary[vertex] && boundary.find(vertex) == vertex) ++facts.boundary_loops;

    facts.euler = static_cast<long>(facts.vertices) - static_cast<long>(facts.edges) +
                  static_cast<long>(facts.triangles - facts.degenerate_triangles);
    const bool manifold = facts.triangles > 0 && facts.degenerate_triangles == 0 && facts.nonmanifold_edges == 0 &&
                          facts.nonmanifold_vertices == 0 && facts.misoriented_edges == 0;
    facts.closed = manifold && facts.boundary_edges == 0;
    if (manifold)
        facts.genus = static_cast<long>(facts.components) - (facts.euler + static_cast<long>(facts.boundary_loops)) / 2;
    return facts;
}

}  // namespace scanmill
