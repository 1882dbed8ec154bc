// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/half_edges.hpp"

#include <algorithm>
#include <numeric>
#include <span>

#include "scanmill/base/error.hpp"

namespace scanmill::sides {

namespace {

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

std::string vertex_text(const TriangleMesh& mesh, u32 vertex) {
    const Vec3 place = mesh.frame.origin + mesh.positions[vertex];
    return fmt::format("vertex {} ({:.9g}, {:.9g}, {:.9g})", vertex, place.x(), place.y(), place.z());
}

/// Edges that no oriented surface has: the first of them as its sides, and their number.
struct Offenders {
    std::vector<Side> first;
    std::size_t edges = 0;

    void add(std::span<const Side> sides) {
        if (edges++ == 0) first.assign(sides.begin(), sides.end());
    }
    std::string edge_text(const TriangleMesh& mesh) const {
        const u32 a = start(mesh, first[0].number), b = end(mesh, first[0].number);
        return fmt::format("the edge between {} and {}", vertex_text(mesh, std::min(a, b)),
                           vertex_text(mesh, std::max(a, b)));
    }
};

void require_two_at_most(const TriangleMesh& mesh, const Offenders& crowded) {
    if (crowded.edges == 0) return;
    throw Error(
        "{} is in {} triangles, {}, {} and {} among them; a surface has at most 2 at an edge (edges with more: {})",
        crowded.edge_text(mesh), crowded.first.size(), crowded.first[0].number / 3, crowded.first[1].number / 3,
        crowded.first[2].number / 3, crowded.edges)
        .hint(
            "take triangles off until two are left at every edge, or cut the mesh there: each sheet with vertices of "
            "its own");
}

void require_orientation(const TriangleMesh& mesh, const Offenders& alike) {
    if (alike.edges == 0) return;
    throw Error("triangles {} and {} pass {} in the same direction; neighbours must be oriented alike (such edges: {})",
                alike.first[0].number / 3, alike.first[1].number / 3, alike.edge_text(mesh), alike.edges)
        .hint("turn the triangles that look the other way; a one-sided surface (a Moebius band) must be cut open");
}

}  // namespace

SidesOfVertices sides_of_vertices(const TriangleMesh& mesh) {
    SidesOfVertices result;
    std::vector<u32>& begin = result.begin;
    begin.resize(mesh.positions.size() + 1);
    const auto for_each_side = [&](auto&& action) {
        for (u32 t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle& triangle = mesh.triangles[t];
            if (names_a_vertex_twice(triangle)) continue;
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

Array<u32> oriented_twins(const TriangleMesh& mesh) {
    require_consistent(mesh);
    constexpr std::size_t most = boundary / 3 - 1;  // sides are numbered with 32 bits
    if (mesh.triangles.size() > most)
        throw Error("the mesh has {} triangles; at most {} are possible", mesh.triangles.size(), most);
    const SidesOfVertices by_vertex = sides_of_vertices(mesh);
    const std::span<const Side> all = by_vertex.sides;
    Array<u32> twins(3 * mesh.triangles.size(), no_side);
    Offenders crowded, alike;
    for (u32 a = 0; a < mesh.positions.size(); ++a)
        for (u32 first = by_vertex.begin[a], last; first < by_vertex.begin[a + 1]; first = last) {
            for (last = first + 1; last < by_vertex.begin[a + 1] && all[last].other == all[first].other;) ++last;
            const std::span<const Side> edge = all.subspan(first, last - first);
            if (edge.size() == 1) {
                twins[edge[0].number] = boundary;
            } else if (edge.size() > 2) {
                crowded.add(edge);
            } else if (start(mesh, edge[0].number) == start(mesh, edge[1].number)) {
                alike.add(edge);
            } else {
                twins[edge[0].number] = edge[1].number;
                twins[edge[1].number] = edge[0].number;
            }
        }
    require_two_at_most(mesh, crowded);
    require_orientation(mesh, alike);
    return twins;
}

}  // namespace scanmill::sides
