// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/live_places.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace scanmill::growing {

LivePlaces::LivePlaces(const Surface& surface)
    : surface_(surface),
      leaves_(std::bit_ceil((surface.positions.size() + leaf_size - 1) / leaf_size)),
      nodes_(2 * leaves_ - 1) {
    const double infinity = std::numeric_limits<double>::infinity();
    for (Node& node : nodes_) node = {Vec3::Constant(infinity), Vec3::Constant(-infinity), false};
    const auto widen = [](Node& node, const Node& by) {
        node = {node.low.cwiseMin(by.low), node.high.cwiseMax(by.high), node.live || by.live};
    };
    for (std::size_t place = 0; place < surface.positions.size(); ++place) {
        const Vec3& p = surface.positions[place];
        widen(nodes_[leaves_ - 1 + place / leaf_size], {p, p, true});
    }
    for (std::size_t node = leaves_ - 1; node-- > 0;) {
        widen(nodes_[node], nodes_[2 * node + 1]);
        widen(nodes_[node], nodes_[2 * node + 2]);
    }
}

void LivePlaces::within(u32 place, double squared, std::vector<u32>& found) { visit(0, place, squared, found); }

void LivePlaces::visit(std::size_t node, u32 place, double squared, std::vector<u32>& found) {
    Node& here = nodes_[node];
    if (!here.live) return;
    const Vec3& p = surface_.positions[place];
    if ((p.cwiseMax(here.low).cwiseMin(here.high) - p).squaredNorm() >= squared) return;
    if (node + 1 >= leaves_) {
        here.live = visit_leaf(node + 1 - leaves_, place, squared, found);
        return;
    }
    visit(2 * node + 1, place, squared, found);
    visit(2 * node + 2, place, squared, found);
    here.live = nodes_[2 * node + 1].live || nodes_[2 * node + 2].live;
}

bool LivePlaces::visit_leaf(std::size_t leaf, u32 place, double squared, std::vector<u32>& found) const {
    bool live = false;
    const std::size_t end = std::min((leaf + 1) * leaf_size, surface_.positions.size());
    for (u32 other = static_cast<u32>(leaf * leaf_size); other < end; ++other) {
        if (surface_.states[other] == PlaceState::interior) continue;
        live = true;
        if (other != place && (surface_.positions[other] - surface_.positions[place]).squaredNorm() < squared)
            found.push_back(other);
    }
    return live;
}

}  // namespace scanmill::growing
