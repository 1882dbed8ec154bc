// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/handles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <queue>
#include <span>
#include <tuple>

#include "scanmill/base/random.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/data/topology.hpp"

namespace scanmill {

namespace {

constexpr double short_loop = 12;  // spacings
constexpr std::size_t vertices_per_loop = 10'000, few_loops = 2;
constexpr u32 none = ~u32(0);

double edge_length(const TriangleMesh& mesh, u32 a, u32 b) { return (mesh.positions[a] - mesh.positions[b]).norm(); }

/// By vertex, a half-edge that starts there; none for unused vertices.
std::vector<u32> starts_of(const TriangleMesh& mesh) {
    std::vector<u32> starts(mesh.positions.size(), none);
    for (u32 h = 0; h < 3 * mesh.triangles.size(); ++h) starts[half_edges::start(mesh, h)] = h;
    return starts;
}

/// Marks the edges of a tree of the vertices of every component, by half-edge: fewest edges to the lowest vertex.
std::vector<bool> tree_of_vertices(const TriangleMesh& mesh, std::span<const u32> opposite) {
    const std::vector<u32> starts = starts_of(mesh);
    std::vector<bool> is_in_tree(opposite.size(), false), reached(starts.size(), false);
    std::vector<u32> order;
    for (u32 root = 0; root < starts.size(); ++root) {
        if (reached[root] || starts[root] == none) continue;
        reached[root] = true;
        order.push_back(root);
        for (std::size_t next = order.size() - 1; next < order.size(); ++next) {
            u32 h = starts[order[next]];
            do {
                const u32 end = half_edges::end(mesh, h);
                if (!reached[end]) {
                    reached[end] = true;
                    is_in_tree[h] = is_in_tree[opposite[h]] = true;
                    order.push_back(end);
                }
                h = opposite[half_edges::before(h)];
            } while (h != starts[order[next]]);
        }
    }
    return is_in_tree;
}

/// By half-edge, a number whose sum along a closed walk is 0 if the walk bounds a part of the surface, and (but for a
/// chance of 2^-64) only then. Each generator has a random number, which flows round a cycle of triangles: across the
/// generator, and back along a spanning tree of the triangles. An edge has the sum of the flows across it.
std::vector<u64> flows(const TriangleMesh& mesh, std::span<const u32> opposite) {
    const std::vector<bool> is_in_tree = tree_of_vertices(mesh, opposite);
    const std::size_t count = mesh.triangles.size();
    std::vector<u32> order, to_parent(count, none);  // half-edge of the triangle towards its parent
    std::vector<bool> reached(count, false);
    for (u32 root = 0; root < count; ++root) {
        if (reached[root]) continue;
        reached[root] = true;
        order.push_back(root);
        for (std::size_t next = order.size() - 1; next < order.size(); ++next)
            for (u32 h = 3 * order[next]; h < 3 * order[next] + 3; ++h) {
                const u32 other = opposite[h] / 3;
                if (is_in_tree[h] || reached[other]) continue;
                reached[other] = true;
                to_parent[other] = opposite[h];
                order.push_back(other);
            }
    }
    std::vector<u64> flow(opposite.size(), 0), into(count, 0);
    Random random(1);
    for (u32 h = 0; h < opposite.size(); ++h) {
        const u32 other = opposite[h];
        if (h > other || is_in_tree[h] || to_parent[h / 3] == h || to_parent[other / 3] == other) continue;
        const u64 number = random.next() | 1;
        into[h / 3] += number;
        into[other / 3] -= number;
        flow[other] = number;
        flow[h] = u64{0} - number;
    }
    for (auto triangle = order.rbegin(); triangle != order.rend(); ++triangle) {
        const u32 h = to_parent[*triangle];
        if (h == none) continue;
        flow[h] = into[*triangle];
        flow[opposite[h]] = u64{0} - into[*triangle];
        into[opposite[h] / 3] += into[*triangle];
    }
    return flow;
}

/// Searches from one vertex after the other; its memory is cleared for the vertices reached only.
class LoopSearch {
public:
    LoopSearch(const TriangleMesh& mesh, std::span<const u32> opposite, std::span<const u64> flow)
        : mesh_(mesh),
          opposite_(opposite),
          flow_(flow),
          starts_(starts_of(mesh)),
          at_(mesh.positions.size()) {}

    struct Found {
        HandleLoop loop;
        u64 flow = 0;  ///< along it, without its sign
    };
    /// The shortest loop below `longest` that consists of two shortest paths from the vertex and an edge, and has a
    /// flow; without length if there is none.
    Found shortest_from(u32 root, double longest) {
        Found best;
        best.loop.length = longest;
        u32 from = none, to = none;
        queue_.emplace(0, root, none, u64{0});
        while (!queue_.empty()) {
            const auto [length, vertex, before, sum] = queue_.top();
            queue_.pop();
            if (at_[vertex].is_reached || 2 * length >= best.loop.length) continue;
            at_[vertex] = {length, before, sum, true};
            reached_.push_back(vertex);
            u32 h = starts_[vertex];
            do {
                const u32 next = half_edges::end(mesh_, h);
                const double edge = edge_length(mesh_, vertex, next);
                const u64 along = sum + flow_[h];
                if (!at_[next].is_reached) {
                    queue_.emplace(length + edge, next, vertex, along);
                } else if (along != at_[next].flow && length + edge + at_[next].length < best.loop.length) {
                    best.loop.length = length + edge + at_[next].length;
                    best.flow = std::min(along - at_[next].flow, at_[next].flow - along);
                    from = vertex, to = next;
                }
                h = opposite_[half_edges::before(h)];
            } while (h != starts_[vertex]);
        }
        if (from != none)
            best.loop.vertices = loop_through(from, to);
        else
            best.loop.length = 0;
        for (const u32 vertex : reached_) at_[vertex] = {};
        reached_.clear();
        queue_ = {};
        return best;
    }

private:
    struct Reached {
        double length = 0;
        u32 before = none;
        u64 flow = 0;
        bool is_reached = false;
    };

    std::vector<u32> loop_through(u32 a, u32 b) const {
        const auto way_to = [&](u32 vertex) {
            std::vector<u32> way;
            for (; vertex != none; vertex = at_[vertex].before) way.push_back(vertex);
            std::ranges::reverse(way);
            return way;
        };
        std::vector<u32> one = way_to(a), two = way_to(b);
        std::size_t shared = 0;
        while (shared < one.size() && shared < two.size() && one[shared] == two[shared]) ++shared;
        one.erase(one.begin(), one.begin() + static_cast<std::ptrdiff_t>(shared - 1));
        one.insert(one.end(), two.rbegin(), two.rend() - static_cast<std::ptrdiff_t>(shared));
        return one;
    }

    const TriangleMesh& mesh_;
    std::span<const u32> opposite_;
    std::span<const u64> flow_;
    std::vector<u32> starts_;
    std::vector<Reached> at_;
    std::vector<u32> reached_;
    using Item = std::tuple<double, u32, u32, u64>;  // length, vertex, the one before it, flow along the path
    std::priority_queue<Item, std::vector<Item>, std::greater<>> queue_;
};

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

std::vector<HandleLoop> handle_loops(const TriangleMesh& mesh, double longest, std::size_t most, Execution& execution) {
    const Array<u32> opposite = half_edges::opposites(mesh);
    const std::vector<u64> flow = flows(mesh, opposite);
    std::vector<bool> is_seed(mesh.positions.size(), false);
    for (u32 h = 0; h < flow.size(); ++h)
        if (flow[h] != 0) is_seed[half_edges::start(mesh, h)] = true;
    LoopSearch search(mesh, opposite, flow);
    std::map<u64, HandleLoop> found;
    for (u32 vertex = 0; vertex < is_seed.size() && found.size() < most; ++vertex) {
        if (!is_seed[vertex]) continue;
        execution.check_cancelled();
        auto [loop, its] = search.shortest_from(vertex, longest);
        if (loop.vertices.empty()) continue;
        const auto [known, is_new] = found.try_emplace(its, loop);
        if (!is_new && loop.length < known->second.length) known->second = std::move(loop);
    }
    std::vector<HandleLoop> loops;
    for (auto& [its, loop] : found) loops.push_back(std::move(loop));
    std::ranges::sort(loops, [](const HandleLoop& a, const HandleLoop& b) {
        return std::tie(a.length, a.vertices) < std::tie(b.length, b.vertices);
    });
    return loops;
}

std::vector<std::string> doubts_about_handles(const TriangleMesh& mesh, Execution& execution,
                                              const std::function<bool(u32 vertex)>& is_invented) {
    const MeshTopology shape = topology(mesh);
    if (!shape.closed || shape.genus.value_or(0) == 0) return {};
    const double spacing = edge_spacing(mesh), limit = short_loop * spacing;
    const std::size_t allowed = std::max(few_loops, shape.vertices / vertices_per_loop);
    // More loops than these give no other answer, unless points are invented.
    const std::size_t most = std::max<std::size_t>(allowed + 1, 100);
    const std::vector<HandleLoop> loops = handle_loops(mesh, limit, most, execution);
    if (loops.empty()) return {};
    const auto where = [&](const HandleLoop& loop) {
        const Vec3 at = mesh.positions[loop.vertices.front()] + mesh.frame.origin;
        return fmt::format("the shortest, of {:.3g} spacings, is at ({:.6g}, {:.6g}, {:.6g})", loop.length / spacing,
                           at.x(), at.y(), at.z());
    };
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
            by_count(static_cast<std::size_t>(count), "a handle passes", "handles pass"),
            where(*std::ranges::find_if(loops, passes_invented)))};
    if (loops.size() > allowed)
        return {fmt::format(
            "the surface has genus {}, and {} loops round its handles are shorter than {} spacings; {}: outliers or "
            "noise may join sheets that are apart; remove outliers first, smooth, or thin the scan less",
            *shape.genus, loops.size(), short_loop, where(loops.front()))};
    return {};
}

}  // namespace scanmill
