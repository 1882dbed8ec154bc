// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/pinches.hpp"

#include <algorithm>

namespace scanmill::growing {

namespace {

using Fan = std::vector<Fans::Pair>;

u32 lowest(const Fan& fan) {
    u32 least = nobody;
    for (const auto& [first, last] : fan) least = std::min({least, first, last});
    return least;
}

/// The vertex's triangles fan by fan.
std::vector<Fan> fans_at(const Surface& surface, u32 vertex) {
    Fan left;
    surface.fans.any(vertex, [&](const Fans::Pair& pair) {
        left.push_back(pair);
        return false;
    });
    std::vector<Fan> fans;
    while (!left.empty()) {
        Fan fan{left.back()};
        left.pop_back();
        for (std::size_t i = 0; i < fan.size(); ++i)
            for (std::size_t j = 0; j < left.size();) {
                if (left[j].first != fan[i].last && left[j].last != fan[i].first) {
                    ++j;
                    continue;
                }
                fan.push_back(left[j]);
                left[j] = left.back();
                left.pop_back();
            }
        fans.push_back(std::move(fan));
    }
    return fans;
}

}  // namespace

std::size_t remove_pinches(Surface& surface) {
    std::vector<u32> suspects;
    for (u32 vertex = 0; vertex < surface.states.size(); ++vertex)
        if (surface.states[vertex] == PlaceState::front) suspects.push_back(vertex);
    std::vector<Triangle> removed;
    for (std::size_t i = 0; i < suspects.size(); ++i) {  // grows on the way
        const u32 vertex = suspects[i];
        std::vector<Fan> fans = fans_at(surface, vertex);
        if (fans.size() < 2) continue;
        const auto stays = std::ranges::max_element(fans, [](const Fan& a, const Fan& b) {
            return a.size() != b.size() ? a.size() < b.size() : lowest(a) > lowest(b);
        });
        for (auto fan = fans.begin(); fan != fans.end(); ++fan) {
            if (fan == stays) continue;
            for (const auto& [first, last] : *fan) {
                const Triangle triangle{vertex, first, last};
                surface.fans.remove(triangle);
                removed.push_back(triangle);
                for (u32 corner : triangle) {
                    surface.states[corner] = surface.fans.empty(corner)    ? PlaceState::unused
                                             : surface.fans.closed(corner) ? PlaceState::interior
                                                                           : PlaceState::front;
                    suspects.push_back(corner);
                }
            }
        }
    }
    const std::size_t count = removed.size();
    surface.drop(std::move(removed));
    return count;
}

}  // namespace scanmill::growing
