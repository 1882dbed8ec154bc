// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/handles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <queue>
#include <tuple>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/data/topology.hpp"

namespace scanmill {

namespace {

constexpr double short_loop = 12;  // spacings
constexpr std::size_t vertices_per_loop = 10'000;
constexpr u32 none = ~u32(0);

/// Shortest paths along edges, from the lowest vertex of every component.
struct ShortestPaths {
    std::vector<double> length;  ///< by vertex
    std::vector<u32> before;  ///< by vertex: the one before it on its path; none at the start

    bool joins(u32 a, u32 b) const { return before[a] == b || before[b] == a; }
};

double edge_length(const TriangleMesh& mesh, u32 a, u32 b) { return (mesh.positions[a] - mesh.positions[b]).norm(); }

ShortestPaths shortest_paths(const TriangleMesh& mesh, std::span<const u32> opposite) {
    const std::size_t count = mesh.positions.size();
    std::vector<u32> from(count, none);  // a half-edge of each used vertex
    for (u32 h = 0; h < opposite.size(); ++h) from[half_edges::start(mesh, h)] = h;
    ShortestPaths paths{std::vector(count, std::numeric_limits<double>::infinity()), std::vector(count, none)};
    using Item = std::tuple<double, u32, u32>;  // length, vertex, the one before it
    std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
    std::vector<bool> reached(count, false);
    for (u32 root = 0; root < count; ++root) {
        if (from[root] == none || reached[root]) continue;
        queue.emplace(0, root, none);
        while (!queue.empty()) {
            const auto [length, vertex, before] = queue.top();
            queue.pop();
            if (reached[vertex]) continue;
            reached[vertex] = true;
            paths.length[vertex] = length;
            paths.before[vertex] = before;
            u32 h = from[vertex];
            do {
                const u32 next = half_edges::end(mesh, h);
                if (!reached[next]) queue.emplace(length + edge_length(mesh, vertex, next), next, vertex);
                h = opposite[half_edges::before(h)];
            } while (h != from[vertex]);
        }
    }
    return paths;
}

HandleLoop loop_through(const TriangleMesh& mesh, const ShortestPaths& paths, u32 a, u32 b) {
    const auto way_to = [&](u32 vertex) {
        std::vector<u32> way;
        for (; vertex != none; vertex = paths.before[vertex]) way.push_back(vertex);
        std::ranges::reverse(way);
        return way;
    };
    const std::vector<u32> one = way_to(a), two = way_to(b);
    std::size_t shared = 0;
    while (shared < one.size() && shared < two.size() && one[shared] == two[shared]) ++shared;
    HandleLoop loop;
    loop.vertices.assign(one.begin() + static_cast<std::ptrdiff_t>(shared - 1), one.end());
    loop.vertices.insert(loop.vertices.end(), two.rbegin(), two.rend() - static_cast<std::ptrdiff_t>(shared));
    for (std::size_t i = 0; i < loop.vertices.size(); ++i)
        loop.length += edge_length(mesh, loop.vertices[i], loop.vertices[(i + 1) % loop.vertices.size()]);
    return loop;
}

/// By vertex, whether one of its triangles is marked as filled.
std::vector<bool> vertices_of_filled(const TriangleMesh& mesh) {
    std::vector<bool> found(mesh.positions.size(), false);
    const Column* filled = mesh.face_columns.find("filled");
    if (!filled || filled->components() != 1) return found;
    for (std::size_t row = 0; row < mesh.triangles.size(); ++row)
        if (filled->number(row) != 0)
            for (const u32 vertex : mesh.triangles[row]) found[vertex] = true;
    return found;
}

}  // namespace

std::vector<HandleLoop> handle_loops(const TriangleMesh& mesh) {
    const Array<u32> opposite = half_edges::opposites(mesh);
    const ShortestPaths paths = shortest_paths(mesh, opposite);
    struct Candidate {
        double length;  ///< of both paths and the edge
        Edge edge;
        u32 half_edge;
        auto key() const { return std::tie(length, edge); }
    };
    std::vector<Candidate> candidates;
    for (u32 h = 0; h < opposite.size(); ++h) {
        const u32 a = half_edges::start(mesh, h), b = half_edges::end(mesh, h);
        if (a < b && !paths.joins(a, b))
            candidates.push_back({paths.length[a] + paths.length[b] + edge_length(mesh, a, b), {a, b}, h});
    }
    // The longest edges that join all triangles of a component cut it to a disc. The others close the loops.
    std::ranges::sort(candidates, std::greater(), &Candidate::key);
    DisjointSets triangles(mesh.triangles.size());
    std::vector<HandleLoop> loops;
    for (const Candidate& candidate : candidates)
        if (!triangles.unite(candidate.half_edge / 3, opposite[candidate.half_edge] / 3))
            loops.push_back(loop_through(mesh, paths, candidate.edge[0], candidate.edge[1]));
    std::ranges::reverse(loops);  // the shortest first
    return loops;
}

std::vector<std::string> doubts_about_handles(const TriangleMesh& mesh,
                                              const std::function<bool(u32 vertex)>& is_invented) {
    const MeshTopology shape = topology(mesh);
    if (!shape.closed || shape.genus.value_or(0) == 0) return {};
    const double spacing = edge_spacing(mesh), limit = short_loop * spacing;
    std::vector<HandleLoop> loops = handle_loops(mesh);
    std::erase_if(loops, [&](const HandleLoop& loop) { return loop.length >= limit; });
    if (loops.empty()) return {};
    const HandleLoop& shortest = *std::ranges::min_element(loops, {}, &HandleLoop::length);
    const Vec3& at = mesh.positions[shortest.vertices.front()] + mesh.frame.origin;
    const std::string where = fmt::format("the shortest, of {:.2g} spacings, is at ({:.6g}, {:.6g}, {:.6g})",
                                          shortest.length / spacing, at.x(), at.y(), at.z());
    const std::vector<bool> filled = is_invented ? std::vector<bool>() : vertices_of_filled(mesh);
    const auto passes_invented = [&](const HandleLoop& loop) {
        return std::ranges::any_of(loop.vertices, [&](u32 v) { return is_invented ? is_invented(v) : filled[v]; });
    };
    if (const auto count = std::ranges::count_if(loops, passes_invented); count > 0)
        return {fmt::format(
            "the surface has genus {}, and {} less than {} spacings round {} through parts that no point shows; {}: "
            "the "
            "object may not have these handles; scan the missing part, or compare the surface with the object",
            *shape.genus, count_text(static_cast<std::size_t>(count), "loop of", "loops of"), short_loop,
            by_count(static_cast<std::size_t>(count), "a handle passes", "handles pass"), where)};
    if (loops.size() > 1 && loops.size() * vertices_per_loop > shape.vertices)
        return {fmt::format(
            "the surface has genus {}, and {} of its loops round handles are shorter than {} spacings; {}: outliers or "
            "noise may join sheets that are apart; remove outliers first, smooth, or thin the scan less",
            *shape.genus, loops.size(), short_loop, where)};
    return {};
}

}  // namespace scanmill
