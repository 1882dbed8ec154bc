// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/pose_graph.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "scanmill/base/disjoint_sets.hpp"

namespace scanmill {

namespace {

constexpr std::size_t no_edge = ~std::size_t(0);

struct Triple {
    std::array<std::size_t, 3> edges;
    bool is_consistent;
};

/// Edges by their two views.
class EdgeTable {
public:
    EdgeTable(std::span<const GraphEdge> edges, std::size_t views) : views_(views), table_(views * views, no_edge) {
        for (std::size_t i = 0; i < edges.size(); ++i) table_[edges[i].from * views + edges[i].to] = i;
    }
    std::size_t operator()(std::size_t from, std::size_t to) const { return table_[from * views_ + to]; }

private:
    std::size_t views_;
    std::vector<std::size_t> table_;
};

std::vector<Triple> triples_of(std::span<const GraphEdge> edges, std::span<const ViewExtent> views, double tolerance) {
    const EdgeTable edge_between(edges, views.size());
    std::vector<Triple> triples;
    for (std::size_t ab = 0; ab < edges.size(); ++ab) {
        const u32 a = edges[ab].from, b = edges[ab].to;
        for (u32 c = b + 1; c < views.size(); ++c) {
            const std::size_t bc = edge_between(b, c), ac = edge_between(a, c);
            if (bc == no_edge || ac == no_edge) continue;
            const RigidMotion around = edges[ab].motion.then(edges[bc].motion);
            const double differs = displacement(around, edges[ac].motion, views[a].centre, views[a].radius);
            triples.push_back({{ab, bc, ac}, differs < tolerance});
        }
    }
    return triples;
}

}  // namespace

CheckedEdges checked_by_triples(std::span<const GraphEdge> edges, std::span<const ViewExtent> views, double tolerance) {
    const std::vector<Triple> triples = triples_of(edges, views, tolerance);
    CheckedEdges checked{std::vector<bool>(edges.size(), true), triples.size(), 0, 0, 0};
    for (const Triple& triple : triples) checked.inconsistent += !triple.is_consistent;
    std::vector<std::size_t> good(edges.size()), bad(edges.size());
    for (;;) {
        std::ranges::fill(good, 0);
        std::ranges::fill(bad, 0);
        for (const Triple& triple : triples)
            if (std::ranges::all_of(triple.edges, [&](std::size_t e) { return checked.is_kept[e]; }))
                for (const std::size_t e : triple.edges) ++(triple.is_consistent ? good : bad)[e];
        std::size_t worst = no_edge;
        for (std::size_t e = 0; e < edges.size(); ++e)
            if (bad[e] > good[e] && (worst == no_edge || bad[e] > bad[worst])) worst = e;
        if (worst == no_edge) break;
        checked.is_kept[worst] = false;
        ++checked.dropped;
    }
    for (std::size_t e = 0; e < edges.size(); ++e)
        if (checked.is_kept[e] && edges[e].is_doubtful && good[e] == 0) {
            checked.is_kept[e] = false;
            ++checked.unconfirmed;
        }
    return checked;
}

SpanningTree largest_tree(std::span<const GraphEdge> edges, std::size_t views) {
    std::vector<std::size_t> order(edges.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, [&](std::size_t i, std::size_t j) {
        const GraphEdge &a = edges[i], &b = edges[j];
        if (a.score != b.score) return a.score > b.score;
        return a.from != b.from ? a.from < b.from : a.to < b.to;
    });
    DisjointSets components(views);
    std::vector<std::size_t> forest;
    for (const std::size_t e : order)
        if (components.unite(edges[e].from, edges[e].to)) forest.push_back(e);

    std::vector<u32> size(views, 0);
    std::vector<double> sum(views, 0);
    for (u32 view = 0; view < views; ++view) ++size[components.find(view)];
    for (const GraphEdge& edge : edges) sum[components.find(edge.from)] += edge.score;
    SpanningTree tree{std::vector<std::optional<RigidMotion>>(views), {}};
    if (views == 0) return tree;
    u32 root = 0;
    for (u32 view = 1; view < views; ++view) {
        const u32 next = components.find(view), best = components.find(root);
        if (size[next] != size[best] ? size[next] > size[best] : sum[next] > sum[best]) root = view;
    }
    for (const std::size_t e : forest)
        if (components.find(edges[e].from) == components.find(root)) tree.edges.push_back(e);

    // Edges are few: repeated passes place the neighbours of placed views.
    tree.poses[root] = RigidMotion{};
    for (bool grows = true; grows;) {
        grows = false;
        for (const std::size_t e : tree.edges) {
            auto &from = tree.poses[edges[e].from], &to = tree.poses[edges[e].to];
            if (from.has_value() == to.has_value()) continue;
            if (from)
                to = edges[e].motion.inverse().then(*from);
            else
                from = edges[e].motion.then(*to);
            grows = true;
        }
    }
    return tree;
}

}  // namespace scanmill
