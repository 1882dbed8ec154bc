// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/patch_edges.hpp"

namespace scanmill::growing {

std::vector<PatchEdge> find_patch_edges(const Surface& surface, PointChooser& chooser, const Limits& limits,
                                        const Context& context) {
    std::size_t looks = 0;
    std::vector<PatchEdge> edges;
    for (const Triangle& triangle : surface.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const u32 from = triangle[i], to = triangle[(i + 1) % 3];
            if (surface.states[from] != PlaceState::front || surface.states[to] != PlaceState::front ||
                surface.fans.right_of(from, to) != nobody)
                continue;
            if (looks++ % 64 == 0) context.check_cancelled();
            const u32 beyond = chooser.beyond_sharp_edge(from, to, limits);
            if (beyond != nobody) edges.push_back({from, to, beyond});
        }
    return edges;
}

}  // namespace scanmill::growing
