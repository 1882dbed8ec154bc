// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The definition of a valid alpha-solid, implemented directly and slowly, as a reference for the filter.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "alpha_solid/alpha_solid.hpp"
#include "alpha_solid/widest_path_sweep.hpp"

namespace scanmill::test {

struct BruteForceVerdict {
    std::size_t covered = 0, components = 0, bad_vertices = 0, bad_edges = 0;
};

/// Facets between cells of the solid and other cells or the outside, as corners in vertices of `tets`.
inline std::vector<Triangle> facets_between(const TetMesh& tets, std::span<const u8> inside) {
    std::vector<Triangle> facets;
    for (u32 c = 0; c < tets.cells.size(); ++c)
        for (int i = 0; i < 4; ++i) {
            const u32 across = tets.neighbours[c][i];
            if (!inside[c] || (across != TetMesh::outside_hull && inside[across])) continue;
            const Tetrahedron& cell = tets.cells[c];
            facets.push_back({cell[(i + 1) % 4], cell[(i + 2) % 4], cell[(i + 3) % 4]});
        }
    return facets;
}

/// Joins `count` members by `pairs`. Returns a number per member; joined members have the same.
inline std::vector<u32> joined_sets(std::size_t count, const std::vector<std::array<u32, 2>>& pairs) {
    std::vector<u32> set(count);
    for (u32 i = 0; i < count; ++i) set[i] = i;
    for (bool changed = true; changed;) {
        changed = false;
        for (const auto& [a, b] : pairs)
            if (set[a] != set[b]) {
                set[a] = set[b] = std::min(set[a], set[b]);
                changed = true;
            }
    }
    return set;
}

/// Whether these link edges form exactly one closed fan: every end is in two of them, and all are in one cycle.
inline bool is_one_closed_fan(const std::vector<std::array<u32, 2>>& link) {
    std::map<u32, std::vector<u32>> beside;
    for (const auto& [a, b] : link) {
        beside[a].push_back(b);
        beside[b].push_back(a);
    }
    for (const auto& [vertex, others] : beside)
        if (others.size() != 2) return false;
    u32 before = link[0][0], at = link[0][1];
    std::size_t walked = 1;
    for (; at != link[0][0]; ++walked) {
        const std::vector<u32>& others = beside[at];
        const u32 next = others[0] == before ? others[1] : others[0];
        before = std::exchange(at, next);
    }
    return walked == link.size();
}

inline BruteForceVerdict brute_force_verdict(const TetMesh& tets, std::span<const u8> inside) {
    const std::vector<Triangle> facets = facets_between(tets, inside);
    BruteForceVerdict verdict;
    std::map<u32, std::vector<std::array<u32, 2>>> links;
    std::map<std::array<u32, 2>, int> facets_of_edge;
    std::vector<std::array<u32, 2>> edges;
    for (const Triangle& facet : facets)
        for (int i = 0; i < 3; ++i) {
            const u32 a = facet[i], b = facet[(i + 1) % 3], c = facet[(i + 2) % 3];
            links[a].push_back({b, c});
            ++facets_of_edge[{std::min(a, b), std::max(a, b)}];
            edges.push_back({a, b});
        }
    for (const auto& [vertex, link] : links) verdict.bad_vertices += !is_one_closed_fan(link);
    for (const auto& [edge, count] : facets_of_edge) verdict.bad_edges += count > 2;
    const std::vector<u32> set = joined_sets(tets.positions.size(), edges);
    std::set<u32> components;
    for (const Triangle& facet : facets) components.insert(set[facet[0]]);
    verdict.components = components.size();
    std::set<u32> covered;
    for (u32 c = 0; c < tets.cells.size(); ++c)
        if (inside[c]) covered.insert(tets.cells[c].begin(), tets.cells[c].end());
    verdict.covered = covered.size();
    return verdict;
}

/// Keeps the cells of the component (joined across facets) with the most points.
inline void keep_largest(const TetMesh& tets, std::vector<u8>& inside) {
    std::vector<std::array<u32, 2>> pairs;
    for (u32 c = 0; c < tets.cells.size(); ++c)
        for (u32 across : tets.neighbours[c])
            if (across != TetMesh::outside_hull && inside[c] && inside[across]) pairs.push_back({c, across});
    const std::vector<u32> set = joined_sets(tets.cells.size(), pairs);
    std::map<u32, std::set<u32>> points;
    for (u32 c = 0; c < tets.cells.size(); ++c)
        if (inside[c]) points[set[c]].insert(tets.cells[c].begin(), tets.cells[c].end());
    u32 largest = 0;
    std::size_t most = 0;
    for (const auto& [component, members] : points)
        if (members.size() > most) {
            most = members.size();
            largest = component;
        }
    for (u32 c = 0; c < tets.cells.size(); ++c) inside[c] = inside[c] && set[c] == largest;
}

/// One of the alpha-solids: the same from squared radius `from` up to, but not at, `to`.
struct BruteForceSolid {
    double from = 0, to = HUGE_VAL;
    bool valid = false;
};

/// Every different alpha-solid, from the least radius up to that of the hull.
inline std::vector<BruteForceSolid> brute_force_spectrum(const TetMesh& tets, const AlphaSolidParams& params) {
    Context context;
    const alpha::SweepResult sweep = alpha::sweep_from_outside(alpha::sweep_cells(tets, context), tets.positions.size(),
                                                               {.value = 0, .coverage = 1}, context);
    const bool single = params.components == AlphaComponents::single, all = params.coverage.value() == 1;
    const auto needed = static_cast<std::size_t>(
        std::ceil(params.coverage.value() * static_cast<double>(tets.positions.size()) - 1e-9));
    std::vector<u8> inside(tets.cells.size(), 0);
    std::vector<BruteForceSolid> spectrum;
    for (std::size_t i = sweep.cells.size(); i-- > 0;) {
        inside[sweep.cells[i]] = 1;
        if (i > 0 && sweep.values[i - 1] == sweep.values[i]) continue;
        std::vector<u8> kept = inside;
        if (single && !all) keep_largest(tets, kept);
        const BruteForceVerdict verdict = brute_force_verdict(tets, kept);
        if (!spectrum.empty()) spectrum.back().to = sweep.values[i];
        spectrum.push_back(
            {sweep.values[i], HUGE_VAL,
             verdict.covered >= needed && verdict.bad_vertices == 0 && (!single || !all || verdict.components == 1)});
    }
    return spectrum;
}

}  // namespace scanmill::test
