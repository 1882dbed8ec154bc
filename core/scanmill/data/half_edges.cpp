// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/half_edges.hpp"

#include <algorithm>
#include <numeric>

#include "scanmill/base/error.hpp"

namespace scanmill::half_edges {

namespace {

std::string vertex_text(const TriangleMesh& mesh, u32 vertex) {
    const Vec3 world = mesh.frame.origin + mesh.positions[vertex];
    return fmt::format("vertex {} ({:.9g}, {:.9g}, {:.9g})", vertex, world.x(), world.y(), world.z());
}

/// Edges that are not allowed: the half-edges of the first such edge, and the number of such edges.
struct Offenders {
    std::vector<VertexHalfEdge> first;
    std::size_t edges = 0;

    void add(std::span<const VertexHalfEdge> half_edges) {
        if (edges++ == 0) first.assign(half_edges.begin(), half_edges.end());
    }
    std::string edge_text(const TriangleMesh& mesh) const {
        const u32 a = start(mesh, first[0].number), b = end(mesh, first[0].number);
        return fmt::format("the edge between {} and {}", vertex_text(mesh, std::min(a, b)),
                           vertex_text(mesh, std::max(a, b)));
    }
};

}  // namespace

ByVertex by_smaller_vertex(const TriangleMesh& mesh) {
    ByVertex result;
    std::vector<u32>& begin = result.begin;
    begin.resize(mesh.positions.size() + 1);
    const auto for_each_half_edge = [&](auto&& action) {
        for (u32 t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle& triangle = mesh.triangles[t];
            if (has_repeated_vertex(triangle)) continue;
            for (u32 i = 0; i < 3; ++i) action(3 * t + i, triangle[i], triangle[i == 2 ? 0 : i + 1]);
        }
    };
    for_each_half_edge([&](u32, u32 a, u32 b) { ++begin[std::min(a, b)]; });
    std::exclusive_scan(begin.begin(), begin.end(), begin.begin(), u32(0));
    result.half_edges.resize(begin.back());
    std::vector<u32> next(begin.begin(), begin.end() - 1);
    for_each_half_edge([&](u32 half_edge, u32 a, u32 b) {
        result.half_edges[next[std::min(a, b)]++] = {std::max(a, b), half_edge};
    });
    const auto at = [&](u32 group) { return result.half_edges.begin() + begin[group]; };
    for (u32 vertex = 0; vertex + 1 < begin.size(); ++vertex) std::sort(at(vertex), at(vertex + 1));
    return result;
}

Array<u32> opposites(const TriangleMesh& mesh) {
    require_consistent(mesh);
    constexpr std::size_t most = boundary / 3 - 1;  // half-edges are numbered with 32 bits
    if (mesh.triangles.size() > most)
        throw Error("the mesh has {} triangles; at most {} are possible", mesh.triangles.size(), most)
            .hint("cut the mesh into parts");
    Array<u32> opposite(3 * mesh.triangles.size(), no_half_edge);
    Offenders crowded, alike;
    for_each_edge(by_smaller_vertex(mesh), [&](u32, std::span<const VertexHalfEdge> edge) {
        if (edge.size() == 1) {
            opposite[edge[0].number] = boundary;
        } else if (edge.size() > 2) {
            crowded.add(edge);
        } else if (start(mesh, edge[0].number) == start(mesh, edge[1].number)) {
            alike.add(edge);
        } else {
            opposite[edge[0].number] = edge[1].number;
            opposite[edge[1].number] = edge[0].number;
        }
    });
    if (crowded.edges > 0)
        throw Error(
            "{} is in {} triangles, among them {}, {} and {}; an edge of a surface is in at most 2 (edges in more: {})",
            crowded.edge_text(mesh), crowded.first.size(), crowded.first[0].number / 3, crowded.first[1].number / 3,
            crowded.first[2].number / 3, crowded.edges)
            .hint(
                "remove triangles until every edge is in at most two, or cut the mesh at these edges by giving each "
                "sheet its own vertices, or mesh the points again")
            .remedy(Remedy::mesh_points);
    if (alike.edges > 0)
        throw Error(
            "triangles {} and {} pass {} in the same direction; neighbours must be oriented alike (such edges: {})",
            alike.first[0].number / 3, alike.first[1].number / 3, alike.edge_text(mesh), alike.edges)
            .hint(
                "reverse the triangles that face the other way, or mesh the points again; a one-sided surface (a "
                "Moebius band) must be cut open")
            .remedy(Remedy::mesh_points);
    return opposite;
}

}  // namespace scanmill::half_edges
