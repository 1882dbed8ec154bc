// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/topology.hpp"

#include <algorithm>
#include <numeric>

namespace scanmill {

namespace {

class UnionFind {
public:
    explicit UnionFind(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), u32(0)); }
    u32 root(u32 item) {
        while (parent_[item] != item) item = parent_[item] = parent_[parent_[item]];
        return item;
    }
    void join(u32 a, u32 b) {
        a = root(a);
        b = root(b);
        if (a != b) parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<u32> parent_;
};

/// One side of a triangle, from `from` to the next corner.
struct Side {
    u64 edge;  // smaller vertex in the high half
    u32 triangle;
    bool forward;  // from the smaller to the larger vertex
};

u32 low(const Side& side) { return static_cast<u32>(side.edge >> 32); }
u32 high(const Side& side) { return static_cast<u32>(side.edge); }

bool is_degenerate(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// The sides of all proper triangles, those of one edge together: a counting sort by the smaller vertex, then tiny
/// sorts.
std::vector<Side> sides_by_edge(const TriangleMesh& mesh) {
    std::vector<u32> begin(mesh.positions.size() + 1, 0);
    const auto for_each_side = [&](auto&& action) {
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle& triangle = mesh.triangles[t];
            if (is_degenerate(triangle)) continue;
            for (int corner = 0; corner < 3; ++corner)
                action(static_cast<u32>(t), triangle[corner], triangle[(corner + 1) % 3]);
        }
    };
    for_each_side([&](u32, u32 a, u32 b) { ++begin[std::min(a, b) + 1]; });
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<Side> sides(begin.back());
    std::vector<u32> next(begin.begin(), begin.end() - 1);
    for_each_side([&](u32 t, u32 a, u32 b) {
        sides[next[std::min(a, b)]++] = {u64(std::min(a, b)) << 32 | std::max(a, b), t, a < b};
    });
    for (std::size_t vertex = 0; vertex + 1 < begin.size(); ++vertex)
        std::sort(sides.begin() + begin[vertex], sides.begin() + begin[vertex + 1], [](const Side& a, const Side& b) {
            return std::pair(a.edge, a.triangle) < std::pair(b.edge, b.triangle);
        });
    return sides;
}

/// The corner number of `vertex` in triangle t.
u32 corner_of(const TriangleMesh& mesh, u32 t, u32 vertex) {
    const Triangle& triangle = mesh.triangles[t];
    return 3 * t + (triangle[0] == vertex ? 0 : triangle[1] == vertex ? 1 : 2);
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

    const std::vector<Side> sides = sides_by_edge(mesh);
    UnionFind faces(mesh.triangles.size());
    // Corners of one vertex that meet across an edge belong to one fan; a manifold vertex has exactly one.
    UnionFind fans(3 * mesh.triangles.size());
    UnionFind boundary(mesh.positions.size());
    std::vector<bool> on_boundary(mesh.positions.size(), false);
    for (std::size_t first = 0, last; first < sides.size(); first = last) {
        last = first + 1;
        while (last < sides.size() && sides[last].edge == sides[first].edge) ++last;
        const std::size_t count = last - first;
        const u32 a = low(sides[first]), b = high(sides[first]);
        ++facts.edges;
        for (std::size_t side = first + 1; side < last; ++side) {
            const u32 t = sides[first].triangle, other = sides[side].triangle;
            faces.join(t, other);
            fans.join(corner_of(mesh, t, a), corner_of(mesh, other, a));
            fans.join(corner_of(mesh, t, b), corner_of(mesh, other, b));
        }
        if (count == 1) {
            ++facts.boundary_edges;
            boundary.join(a, b);
            on_boundary[a] = on_boundary[b] = true;
        } else if (count > 2) {
            ++facts.nonmanifold_edges;
            unmanifold[a] = unmanifold[b] = true;
        } else if (sides[first].forward == sides[first + 1].forward) {
            ++facts.misoriented_edges;
        }
    }

    constexpr u32 none = ~u32(0);
    std::vector<u32> fan_of_vertex(mesh.positions.size(), none);
    for (u32 t = 0; t < mesh.triangles.size(); ++t) {
        if (is_degenerate(mesh.triangles[t])) continue;
        if (faces.root(t) == t) ++facts.components;
        for (u32 corner = 0; corner < 3; ++corner) {
            const u32 vertex = mesh.triangles[t][corner];
            const u32 fan = fans.root(3 * t + corner);
            if (fan_of_vertex[vertex] == none)
                fan_of_vertex[vertex] = fan;
            else if (fan_of_vertex[vertex] != fan)
                unmanifold[vertex] = true;
        }
    }
    facts.nonmanifold_vertices = static_cast<std::size_t>(std::ranges::count(unmanifold, true));
    for (u32 vertex = 0; vertex < on_boundary.size(); ++vertex)
        if (on_boundary[vertex] && boundary.root(vertex) == vertex) ++facts.boundary_loops;

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
