// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/distance/self_intersections.hpp"

#include <algorithm>
#include <vector>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/distance/triangles_intersect.hpp"
#include "scanmill/geometry/mesh/coincident.hpp"

namespace scanmill {

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
