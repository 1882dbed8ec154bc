// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/topology.hpp"

#include <algorithm>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/geometry/mesh/half_edges.hpp"

namespace scanmill {

using sides::after, sides::before;

namespace {

constexpr u32 none = ~u32(0);

/// Whether the corner's fan, found by going around its vertex from triangle to triangle, has so many corners. Pre: no
/// edge at the vertex is in more than two triangles.
bool fan_has(const TriangleMesh& mesh, const std::vector<u32>& twins, u32 corner, u32 corners) {
    const u32 vertex = sides::start(mesh, corner);
    u32 seen = 1;
    for (const u32 first : {corner, before(corner)}) {
        for (u32 side = first; twins[side] != none; ++seen) {
            const u32 twin = twins[side];
            const bool starts_here = sides::start(mesh, twin) == vertex;
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
        if (sides::names_a_vertex_twice(triangle)) ++facts.degenerate_triangles;
        for (u32 vertex : triangle) used[vertex] = true;
    }
    facts.vertices = static_cast<std::size_t>(std::ranges::count(used, true));
    facts.unused_vertices = used.size() - facts.vertices;

    const sides::SidesOfVertices by_vertex = sides::sides_of_vertices(mesh);
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
                if (sides::start(mesh, side) == sides::start(mesh, twin)) ++facts.misoriented_edges;
            }
        }

    std::vector<u32> corner_of(mesh.positions.size(), none), corners(mesh.positions.size(), 0);
    for (u32 t = 0; t < mesh.triangles.size(); ++t) {
        if (sides::names_a_vertex_twice(mesh.triangles[t])) continue;
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
