// SPDX-License-Identifier: GPL-3.0-or-later
#include "fill_holes/fillings.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/distance/triangles_intersect.hpp"
#include "scanmill/geometry/mesh/coincident.hpp"
#include "scanmill/geometry/mesh/hole_triangulation.hpp"

namespace scanmill {

namespace {

/// Largest number of edges for least_triangulation(). A loop of 100 edges has 161,700 possible triangles, which take
/// about 1 µs each.
constexpr std::size_t most_edges_to_avoid = 100;

BoundingBox box_of(std::span<const Vec3> positions, const Triangle& triangle) {
    BoundingBox box;
    for (const u32 vertex : triangle) box.add(positions[vertex]);
    return box;
}

/// Whether the hole waits for Conflicts::avoid().
bool is_to_avoid(const Hole& hole) {
    return !hole.open && hole.stage == FillingStage::avoiding && hole.triangles.empty();
}

u64 key(u32 a, u32 b) { return u64{std::min(a, b)} << 32 | std::max(a, b); }

u32 loser_of(u32 one, u32 other, std::span<const Hole> holes) {
    const std::size_t edges = holes[one].loop.size(), others = holes[other].loop.size();
    return edges > others || (edges == others && one > other) ? one : other;
}

}  // namespace

void Hole::demote() {
    if (stage == FillingStage::avoiding)
        open = true;
    else
        stage = static_cast<FillingStage>(static_cast<int>(stage) - 1);
    positions.clear();
    triangles.clear();
}

Assembly::Assembly(const TriangleMesh& mesh, std::span<const Hole> holes)
    : positions(mesh.positions.begin(), mesh.positions.end()),
      triangles(mesh.triangles.begin(), mesh.triangles.end()) {
    const u32 vertices = static_cast<u32>(mesh.positions.size());
    for (u32 i = 0; i < holes.size(); ++i) {
        const u32 shift = static_cast<u32>(positions.size()) - vertices;
        positions.insert(positions.end(), holes[i].positions.begin(), holes[i].positions.end());
        for (Triangle triangle : holes[i].triangles) {
            for (u32& vertex : triangle)
                if (vertex >= vertices) vertex += shift;
            triangles.push_back(triangle);
            owners.push_back(i);
        }
    }
}

Conflicts::Conflicts(const TriangleMesh& mesh, std::span<const Hole> holes)
    : mesh_(mesh),
      vertices_(static_cast<u32>(mesh.positions.size())),
      count_(static_cast<u32>(mesh.triangles.size())),
      lowest_(lowest_at_position(mesh.positions.span())) {
    std::vector<bool> is_in_loop(mesh.positions.size(), false);
    for (const Hole& hole : holes)
        for (const u32 h : hole.loop) is_in_loop[half_edges::start(mesh, h)] = true;
    for (const Triangle& triangle : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i)
            if (const u32 a = triangle[i], b = triangle[(i + 1) % 3]; is_in_loop[a] && is_in_loop[b])
                loop_edges_.insert(key(a, b));
}

struct Conflicts::Nearby {
    Array<Triangle> triangles;
    std::optional<TriangleTree> tree;  ///< empty without triangles

    /// Whether meets(triangle) is true for any triangle whose box meets `box`. `rows`: reused memory.
    template <class Meets>
    bool any_meets(const BoundingBox& box, Array<u32>& rows, const Meets& meets) const {
        rows.clear();
        if (tree) tree->meeting(box, rows);
        return std::ranges::any_of(rows, [&](u32 row) { return meets(triangles[row]); });
    }
};

Conflicts::Nearby Conflicts::nearby(const TriangleTree& others, const Execution& execution) const {
    constexpr std::size_t chunk = 1 << 12;
    std::vector<Array<Triangle>> parts((mesh_.triangles.size() + chunk - 1) / chunk);
    for_each_chunk(execution.threads(), mesh_.triangles.size(), chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        Array<u32> rows;
        for (std::size_t f = begin; f < end; ++f) {
            rows.clear();
            others.meeting(box_of(mesh_.positions, mesh_.triangles[f]), rows);
            if (!rows.empty()) parts[begin / chunk].push_back(mesh_.triangles[f]);
        }
    });
    Nearby found;
    for (const Array<Triangle>& part : parts) found.triangles.insert(found.triangles.end(), part.begin(), part.end());
    if (!found.triangles.empty()) found.tree.emplace(mesh_.positions.span(), found.triangles, execution.threads());
    return found;
}

void Conflicts::avoid(std::vector<Hole>& holes, const Execution& execution) const {
    std::vector<u32> waiting;
    Array<Vec3> corners;  // corners of the loops' boxes; `boxes` holds them as triangles
    Array<Triangle> boxes;
    for (u32 i = 0; i < holes.size(); ++i) {
        if (!is_to_avoid(holes[i])) continue;
        holes[i].open = holes[i].loop.size() > most_edges_to_avoid;
        if (holes[i].open) continue;
        waiting.push_back(i);
        BoundingBox box;
        for (const u32 h : holes[i].loop) box.add(mesh_.positions[half_edges::start(mesh_, h)]);
        const u32 low = static_cast<u32>(corners.size());
        corners.push_back(box.low);
        corners.push_back(box.high);
        boxes.push_back({low, low + 1, low});
    }
    if (waiting.empty()) return;
    const Nearby around = nearby(TriangleTree(corners, boxes, execution.threads()), execution);
    for_each_chunk(execution.threads(), waiting.size(), 1, [&](std::size_t i, std::size_t) {
        Hole& hole = holes[waiting[i]];
        hole.triangles = least_triangulation(hole.loop, around, execution);
        hole.open = hole.triangles.empty();
    });
}

bool Conflicts::resolve(const Assembly& all, std::vector<Hole>& holes, const Execution& execution) const {
    const u32 added = static_cast<u32>(all.owners.size());
    if (added == 0) return false;
    const TriangleTree fillings(all.positions, std::span(all.triangles).subspan(count_), execution.threads());
    const Nearby around = nearby(fillings, execution);
    std::vector<u32> begin{0};
    for (u32 i = 1; i <= added; ++i)
        if (i == added || all.owners[i] != all.owners[i - 1]) begin.push_back(i);

    std::vector<std::vector<u32>> losers(begin.size());
    losers.back() = owners_of_repeated_edges(all, begin, holes);
    for_each_chunk(execution.threads(), begin.size() - 1, 1, [&](std::size_t hole, std::size_t) {
        Array<u32> near;
        const u32 owner = all.owners[begin[hole]];
        for (u32 i = begin[hole]; i < begin[hole + 1]; ++i) {
            if ((i & 255) == 0) execution.check_cancelled();
            const BoundingBox box = box_of(all.positions, all.triangles[count_ + i]);
            const Triangle triangle = joined(all.triangles[count_ + i]);
            const auto meets = [&](const Triangle& other) {
                return triangles_intersect(all.positions, triangle, joined(other));
            };
            bool gives_way = around.any_meets(box, near, meets);
            near.clear();
            if (!gives_way) fillings.meeting(box, near);
            for (const u32 row : near) {
                const u32 other = all.owners[row];
                if (row == i || !meets(all.triangles[count_ + row])) continue;
                if (other == owner) gives_way = true;
                if (other != owner) losers[hole].push_back(loser_of(owner, other, holes));
            }
            if (gives_way) {
                losers[hole] = {owner};
                break;
            }
        }
    });
    std::vector<bool> demoted(holes.size(), false);
    bool any = false;
    for (const std::vector<u32>& some : losers)
        for (const u32 loser : some)
            if (!demoted[loser]) {
                holes[loser].demote();
                demoted[loser] = any = true;
            }
    return any;
}

std::vector<Triangle> Conflicts::least_triangulation(std::span<const u32> loop, const Nearby& around,
                                                     const Execution& execution) const {
    constexpr double impossible = HoleTriangulation::impossible;
    const auto vertex = [&](u32 i) { return half_edges::start(mesh_, loop[i]); };
    // The surface is on the left of the loop, so the triangulation runs in the opposite direction.
    const auto triangle = [&](u32 i, u32 k, u32 j) { return Triangle{vertex(j), vertex(k), vertex(i)}; };
    const auto edge_cost = [&](u32 i, u32 j) {
        execution.check_cancelled();
        return loop_edges_.contains(key(vertex(i), vertex(j))) ? impossible : 0;
    };
    const auto area = [&](u32 i, u32 k, u32 j) {
        const auto [a, b, c] = triangle(i, k, j);
        const auto& p = mesh_.positions;
        return (p[b] - p[a]).cross(p[c] - p[a]).norm();
    };
    Array<u32> near;
    const auto is_free = [&](u32 i, u32 k, u32 j) {
        const Triangle its = triangle(i, k, j);
        return !around.any_meets(box_of(mesh_.positions, its), near, [&](const Triangle& other) {
            return triangles_intersect(mesh_.positions.span(), joined(its), joined(other));
        });
    };
    HoleTriangulation best;
    std::vector<Triangle> triangles;
    if (best.solve(static_cast<u32>(loop.size()), edge_cost, area, is_free))
        for (const auto& [i, k, j] : best.triangles()) triangles.push_back(triangle(i, k, j));
    std::ranges::reverse(triangles);
    return triangles;
}

Triangle Conflicts::joined(Triangle triangle) const {
    for (u32& vertex : triangle)
        if (vertex < vertices_) vertex = lowest_[vertex];
    return triangle;
}

/// Holes whose triangulation repeats an edge: it has an inner edge, between two vertices of loops, that the mesh or
/// another triangulation has as well. Of two triangulations with the same edge, only the one that gives way counts.
std::vector<u32> Conflicts::owners_of_repeated_edges(const Assembly& all, std::span<const u32> begin,
                                                     std::span<const Hole> holes) const {
    std::vector<u32> losers;
    std::unordered_map<u64, u32> owner_of;
    std::vector<u64> edges;
    for (std::size_t hole = 0; hole + 1 < begin.size(); ++hole) {
        const u32 owner = all.owners[begin[hole]];
        edges.clear();
        for (u32 i = begin[hole]; i < begin[hole + 1]; ++i)
            for (std::size_t k = 0; k < 3; ++k)
                if (const u32 a = all.triangles[count_ + i][k], b = all.triangles[count_ + i][(k + 1) % 3];
                    a < vertices_ && b < vertices_)
                    edges.push_back(key(a, b));
        std::ranges::sort(edges);
        for (std::size_t i = 1; i < edges.size(); ++i) {
            if (edges[i] != edges[i - 1]) continue;  // an edge of the loop: only one triangle has it
            if (loop_edges_.contains(edges[i])) losers.push_back(owner);
            const auto [found, is_new] = owner_of.try_emplace(edges[i], owner);
            if (!is_new) losers.push_back(loser_of(owner, found->second, holes));
        }
    }
    return losers;
}

void fill(Hole& hole, const TriangleMesh& mesh, const MeshLoops& boundary, const Execution& execution) {
    if (hole.stage == FillingStage::avoiding) return;
    const Cutout cutout(mesh, boundary, hole.loop);
    const u32 around = static_cast<u32>(cutout.vertices.size()), vertices = static_cast<u32>(mesh.positions.size());
    while (hole.stage != FillingStage::avoiding) {
        LoopFilling filling = fill_loop(cutout.part, hole.stage, execution);
        if (filling.triangles.empty()) {
            hole.demote();
            continue;
        }
        hole.positions = std::move(filling.positions);
        for (Triangle& triangle : filling.triangles)
            for (u32& vertex : triangle)
                vertex = vertex < around ? cutout.vertices[vertex] : vertices + (vertex - around);
        hole.triangles = std::move(filling.triangles);
        return;
    }
}

}  // namespace scanmill
