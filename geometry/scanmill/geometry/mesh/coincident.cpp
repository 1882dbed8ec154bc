// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/coincident.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "scanmill/data/half_edges.hpp"

namespace scanmill {

Array<u32> lowest_at_position(std::span<const Vec3> positions) {
    constexpr u32 nobody = ~u32(0);
    const std::size_t mask = std::bit_ceil(2 * positions.size() + 1) - 1;
    std::vector<u32> slots(mask + 1, nobody);  // a hash table with linear probing
    const auto hash = [](const Vec3& position) {
        u64 mixed = 0;
        for (const double coordinate : position) {
            mixed = (mixed ^ std::bit_cast<u64>(coordinate + 0.0)) * 0x9e3779b97f4a7c15u;  // -0 + 0 is 0
            mixed ^= mixed >> 32;
        }
        return static_cast<std::size_t>(mixed);
    };
    Array<u32> lowest(positions.size());
    for (u32 row = 0; row < positions.size(); ++row) {
        std::size_t slot = hash(positions[row]) & mask;
        while (slots[slot] != nobody && positions[slots[slot]] != positions[row]) slot = (slot + 1) & mask;
        if (slots[slot] == nobody) slots[slot] = row;
        lowest[row] = slots[slot];
    }
    return lowest;
}

std::vector<u32> coincident_edges(const TriangleMesh& mesh, std::span<const u32> boundary) {
    if (boundary.empty()) return {};
    const Array<u32> lowest = lowest_at_position(mesh.positions.span());
    std::vector<std::pair<Edge, u32>> edges;
    for (u32 i = 0; i < boundary.size(); ++i)
        edges.emplace_back(
            make_edge(lowest[half_edges::start(mesh, boundary[i])], lowest[half_edges::end(mesh, boundary[i])]), i);
    std::ranges::sort(edges);
    std::vector<u32> coincident;
    for (std::size_t i = 0; i < edges.size(); ++i)
        if ((i > 0 && edges[i].first == edges[i - 1].first) ||
            (i + 1 < edges.size() && edges[i].first == edges[i + 1].first))
            coincident.push_back(edges[i].second);
    std::ranges::sort(coincident);
    for (u32& each : coincident) each = boundary[each];
    return coincident;
}

}  // namespace scanmill
