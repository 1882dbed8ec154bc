// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/distance/self_intersections.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/distance/triangles_intersect.hpp"

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

namespace {

BoundingBox box_of(std::span<const Vec3> positions, const Triangle& triangle) {
    BoundingBox box;
    for (const u32 vertex : triangle) box.add(positions[vertex]);
    return box;
}

}  // namespace

SelfIntersections self_intersections(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                     const TriangleTree& tree, Execution& execution, u64 most_pairs) {
    const Array<u32> vertices = lowest_at_position(positions);
    const auto merged = [&](u32 row) -> Triangle {
        const auto& [a, b, c] = triangles[row];
        return {vertices[a], vertices[b], vertices[c]};
    };
    constexpr std::size_t chunk = 1 << 10;
    std::vector<SelfIntersections> found((triangles.size() + chunk - 1) / chunk);
    for_each_chunk(execution.threads(), triangles.size(), chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        SelfIntersections& mine = found[begin / chunk];
        Array<u32> near;
        for (std::size_t i = begin; i < end; ++i) {
            const u32 row = static_cast<u32>(i);
            const Triangle triangle = merged(row);
            near.clear();
            tree.meeting(box_of(positions, triangle), near);
            std::erase_if(near, [&](u32 other) {
                return other <= row || !triangles_intersect(positions, triangle, merged(other));
            });
            mine.count += near.size();
            std::ranges::sort(near);
            for (std::size_t k = 0; k < near.size() && mine.pairs.size() < most_pairs; ++k)
                mine.pairs.push_back({row, near[k]});
        }
    });
    SelfIntersections all;
    for (const SelfIntersections& part : found) {
        all.count += part.count;
        const u64 wanted = std::min<u64>(part.pairs.size(), most_pairs - all.pairs.size());
        all.pairs.insert(all.pairs.end(), part.pairs.begin(), part.pairs.begin() + static_cast<std::ptrdiff_t>(wanted));
    }
    return all;
}

}  // namespace scanmill
