// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/patch_edges.hpp"

namespace scanmill::growing {

std::vector<Edge> find_patch_edges(const Surface& surface, PointChooser& chooser, const Limits& limits) {
    std::vector<Edge> edges;
    for (const Triangle& triangle : surface.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const u32 from = triangle[i], to = triangle[(i + 1) % 3];
            if (surface.states[from] != PlaceState::front || surface.states[to] != PlaceState::front ||
                surface.fans.right_of(from, to) != nobody)
                continue;
            if (chooser.ends_at_other_patch(from, to, limits)) edges.push_back(make_edge(from, to));
        }
    return edges;
}

}  // namespace scanmill::growing
