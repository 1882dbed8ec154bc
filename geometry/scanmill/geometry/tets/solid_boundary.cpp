// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/tets/solid_boundary.hpp"

#include <algorithm>
#include <atomic>
#include <bit>

#include "scanmill/base/parallel.hpp"

namespace scanmill {

namespace {

constexpr std::size_t chunk = 1 << 14;
constexpr u8 solid = 1;

/// Longer links are sorted by `from` before they are searched.
constexpr std::size_t few = 32;

/// The edge that starts at `vertex`, or nullptr.
const LinkEdge* starting_at(std::span<const LinkEdge> link, u32 vertex) {
    const auto found = link.size() <= few ? std::ranges::find(link, vertex, &LinkEdge::from)
                                          : std::ranges::lower_bound(link, vertex, {}, &LinkEdge::from);
    return found == link.end() || found->from != vertex ? nullptr : &*found;
}

bool is_one_cycle(std::span<const LinkEdge> link) {
    std::size_t walked = 1;
    for (u32 at = link[0].to; at != link[0].from; ++walked) {
        const LinkEdge* edge = starting_at(link, at);
        // If several edges start at one vertex, the walk always takes the same edge. It then misses the others or never
        // ends.
        if (edge == nullptr || walked > link.size()) return false;
        at = edge->to;
    }
    return walked == link.size();
}

/// Counts the edges from `centre` to larger vertices that have more than two triangles. Several link edges start at
/// such a vertex.
std::size_t surplus_edges(std::span<LinkEdge> link, u32 centre) {
    std::ranges::sort(link, {}, &LinkEdge::from);
    std::size_t count = 0;
    for (std::size_t i = 1; i < link.size(); ++i)
        count +=
            link[i].from > centre && link[i].from == link[i - 1].from && (i == 1 || link[i - 2].from != link[i].from);
    return count;
}

}  // namespace

Array<u32> hidden_vertices(const TetMesh& tets) {
    std::vector<bool> in_cell(tets.positions.size());
    for (const Tetrahedron& cell : tets.cells)
        for (u32 vertex : cell) in_cell[vertex] = true;
    Array<u32> hidden;
    for (u32 vertex = 0; vertex < in_cell.size(); ++vertex)
        if (!in_cell[vertex]) hidden.push_back(vertex);
    return hidden;
}

Array<Triangle> boundary_triangles(const TetMesh& tets, std::span<const u8> labels, unsigned threads) {
    const std::size_t cells = tets.cells.size();
    // For each cell, one bit for each corner whose facet is on the boundary. So the labels of neighbours are read only
    // once.
    Array<u8> open(cells);
    Array<std::size_t> starts((cells + chunk - 1) / chunk);
    for_each_chunk(threads, cells, chunk, [&](std::size_t begin, std::size_t end) {
        std::size_t count = 0;
        for (std::size_t c = begin; c < end; ++c) {
            unsigned mask = 0;
            if (labels[c] == solid)
                for (int corner = 0; corner < 4; ++corner) {
                    const u32 across = tets.neighbours[c][corner];
                    const bool at_hull = across == TetMesh::outside_hull;
                    // There is no branch here, because it cannot be predicted which facets are on the boundary.
                    const unsigned is_open = unsigned(at_hull) | unsigned(labels[at_hull ? 0 : across] != solid);
                    mask |= is_open << corner;
                    count += is_open;
                }
            open[c] = static_cast<u8>(mask);
        }
        starts[begin / chunk] = count;
    });
    std::size_t total = 0;
    for (std::size_t& entry : starts) total += std::exchange(entry, total);

    Array<Triangle> triangles(total);
    for_each_chunk(threads, cells, chunk, [&](std::size_t begin, std::size_t end) {
        std::size_t next = starts[begin / chunk];
        for (std::size_t c = begin; c < end; ++c)
            for (unsigned left = open[c]; left != 0; left &= left - 1) {
                const auto& [i, j, k] = outward_facet[static_cast<std::size_t>(std::countr_zero(left))];
                triangles[next++] = {tets.cells[c][i], tets.cells[c][j], tets.cells[c][k]};
            }
    });
    return triangles;
}

TriangleMesh boundary_mesh(const TetMesh& tets, Array<Triangle> triangles) {
    TriangleMesh mesh;
    mesh.frame = tets.frame;
    mesh.positions = tets.positions;
    mesh.vertex_columns = tets.vertex_columns;
    mesh.triangles = std::move(triangles);
    return without_unused_vertices(mesh);
}

void fill_cavities(const TetMesh& tets, std::span<u8> labels) {
    std::vector<u32> stack;
    Array<u8> reached(labels.size());
    std::ranges::fill(reached, u8(0));
    const auto reach = [&](u32 cell) {
        if (labels[cell] != solid && std::exchange(reached[cell], u8(1)) == 0) stack.push_back(cell);
    };
    for (u32 cell = 0; cell < labels.size(); ++cell)
        if (std::ranges::count(tets.neighbours[cell], TetMesh::outside_hull) > 0) reach(cell);
    while (!stack.empty()) {
        const u32 cell = stack.back();
        stack.pop_back();
        for (const u32 across : tets.neighbours[cell])
            if (across != TetMesh::outside_hull) reach(across);
    }
    for (u32 cell = 0; cell < labels.size(); ++cell)
        if (!reached[cell]) labels[cell] = solid;
}

BoundaryLinks::BoundaryLinks(std::span<const Triangle> triangles, std::size_t vertices, unsigned threads)
    : ends_(vertices),
      edges_(3 * triangles.size()) {
    std::ranges::fill(ends_, 0);
    const auto claim = [&, alone = threads <= 1](u32 vertex) {
        return alone ? ends_[vertex]++ : std::atomic_ref(ends_[vertex]).fetch_add(1, std::memory_order_relaxed);
    };
    for_each_chunk(threads, triangles.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
            for (u32 corner : triangles[t]) claim(corner);
    });
    u32 start = 0;
    for (u32& entry : ends_) start += std::exchange(entry, start);
    // Every claim() increases a start, so at the end each start has become the start of the next vertex.
    for_each_chunk(threads, triangles.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const auto& [a, b, c] = triangles[t];
            edges_[claim(a)] = {b, c};
            edges_[claim(b)] = {c, a};
            edges_[claim(c)] = {a, b};
        }
    });
}

BoundaryDefects boundary_defects(std::span<const Triangle> triangles, std::size_t vertices, unsigned threads) {
    BoundaryLinks links(triangles, vertices, threads);
    return boundary_defects(links, threads);
}

BoundaryDefects boundary_defects(BoundaryLinks& links, unsigned threads) {
    std::vector<BoundaryDefects> per_chunk((links.vertices() + chunk - 1) / chunk);
    for_each_chunk(threads, links.vertices(), chunk, [&](std::size_t begin, std::size_t end) {
        BoundaryDefects& defects = per_chunk[begin / chunk];
        for (std::size_t vertex = begin; vertex < end; ++vertex) {
            const std::span<LinkEdge> link = links.of(vertex);
            if (link.empty()) continue;
            if (link.size() > few) std::ranges::sort(link, {}, &LinkEdge::from);
            if (is_one_cycle(link)) continue;
            defects.vertices.push_back(static_cast<u32>(vertex));
            defects.edges += surplus_edges(link, static_cast<u32>(vertex));
        }
    });
    BoundaryDefects all;
    for (const BoundaryDefects& part : per_chunk) {
        all.vertices.insert(all.vertices.end(), part.vertices.begin(), part.vertices.end());
        all.edges += part.edges;
    }
    return all;
}

std::size_t join_vertices(std::span<const Triangle> triangles, DisjointSets& vertices) {
    for (const auto& [a, b, c] : triangles) {
        vertices.unite(a, b);
        vertices.unite(a, c);
    }
    Array<u32> roots;
    for (const Triangle& triangle : triangles)
        if (const u32 root = vertices.find(triangle[0]); roots.empty() || roots.back() != root) roots.push_back(root);
    std::ranges::sort(roots);
    return std::ranges::unique(roots).begin() - roots.begin();
}

}  // namespace scanmill
